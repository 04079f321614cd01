"""Find the scenarios in a folder and in the folders below it."""

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from armour.cli.console import say
from armour.errors import InputError, Problem, counted, mistake, refuse
from armour.files import read_toml, reason

# A TOML file is a scenario if it has one of these sections.
OF_SCENARIO = ("impact", "threat", "armour")


def scenario_paths(sources: Sequence[Path]) -> list[Path]:
    """Replace each folder among paths and names of scenarios by the scenarios in it and in the folders below.

    A note counts the files that are skipped.
    """
    skipped = dict[Path, str]()
    scenarios = {source: _scenarios_in(source, skipped) for source in dict.fromkeys(sources) if os.path.isdir(source)}
    if skipped:
        nouns = sorted(Counter(skipped.values()).items())
        say(f"note: skipped {', '.join(counted(count, noun) for noun, count in nouns)}")
    message = "must be a folder of scenarios, found none in it"
    refuse(Problem(str(source), "", message) for source, paths in scenarios.items() if not paths)
    return list(dict.fromkeys(path for source in sources for path in scenarios.get(source, [source])))


def _scenarios_in(top: Path, skipped: dict[Path, str]) -> list[Path]:
    """Return the scenarios in a folder and in the folders below, sorted; add other files, with kinds, to `skipped`."""

    def fail(error: OSError) -> None:
        raise mistake(error.filename, "", f"cannot be read: {reason(error)}")

    paths: list[Path] = []
    for folder, folders, files in os.walk(top, onerror=fail):
        names = [*folders, *(name for name in files if name.lower().endswith(".toml"))]
        reasons = {name: _reason_to_skip(Path(folder, name)) for name in names}
        skipped.update((Path(folder, name), kind) for name, kind in reasons.items() if kind)
        folders[:] = [name for name in folders if not reasons[name]]
        paths += [Path(folder, name) for name in files if reasons.get(name) == ""]
    return sorted(paths)


def _reason_to_skip(path: Path) -> str:
    """Return why a file or folder is skipped, as its kind, such as "hidden file"; "" if it is not."""
    if path.name.startswith("."):
        return "hidden folder" if path.is_dir() else "hidden file"
    if path.is_symlink():
        return "link"
    if path.is_dir():
        return f"virtual environment ({path})" if (path / "pyvenv.cfg").exists() else ""
    if not path.is_file():
        return "pipe or socket"
    try:
        return "other .toml file" if read_toml(path).keys().isdisjoint(OF_SCENARIO) else ""
    except InputError:
        return ""  # the reader of scenarios tells its mistakes
