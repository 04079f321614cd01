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
    skipped = Counter[tuple[str, str]]()
    files = {source: _toml_files(source, skipped) for source in dict.fromkeys(sources) if os.path.isdir(source)}
    scenarios = {source: [path for path in paths if _is_scenario(path)] for source, paths in files.items()}
    others = sum(map(len, files.values())) - sum(map(len, scenarios.values()))
    skipped["file", " without [impact], [[threat]] or [armour]"] = others
    parts = [counted(count, noun) + rest for (noun, rest), count in sorted(skipped.items()) if count]
    if parts:
        say(f"note: skipped {', '.join(parts)}")
    message = "must be a folder of scenarios, found none in it"
    refuse(Problem(str(source), "", message) for source, paths in scenarios.items() if not paths)
    return list(dict.fromkeys(path for source in sources for path in scenarios.get(source, [source])))


def _toml_files(top: Path, skipped: Counter[tuple[str, str]]) -> list[Path]:
    """Return the TOML files in a folder and in the folders below, sorted, and count in `skipped` what is passed over.

    Hidden files and folders, links and virtual environments are skipped.
    """

    def fail(error: OSError) -> None:
        raise mistake(error.filename, "", f"cannot be read: {reason(error)}")

    paths: list[Path] = []
    for folder, folders, files in os.walk(top, onerror=fail):
        names = [*folders, *(name for name in files if name.lower().endswith(".toml"))]
        nouns = {name: _foreign(Path(folder, name)) for name in names}
        skipped.update((noun, "") for noun in nouns.values() if noun)
        folders[:] = [name for name in folders if not nouns[name]]
        paths += [Path(folder, name) for name in files if nouns.get(name) == ""]
    return sorted(paths)


def _foreign(path: Path) -> str:
    """Return why a file or folder is skipped, such as "hidden file"; "" if it is not."""
    if path.name.startswith("."):
        return "hidden folder" if path.is_dir() else "hidden file"
    if path.is_symlink():
        return "link"
    if path.is_dir():
        return "virtual environment" if (path / "pyvenv.cfg").exists() else ""
    return "" if path.is_file() else "pipe or socket"


def _is_scenario(path: Path) -> bool:
    """Return whether to read a file as a scenario; also if it is not valid TOML, so that its mistakes are reported."""
    try:
        return not read_toml(path).keys().isdisjoint(OF_SCENARIO)
    except InputError:
        return True
