"""Commands on shipped data: search the library, copy files to start from, and print the schema."""

from collections.abc import Mapping, Sequence
from os.path import relpath
from pathlib import Path
from typing import Any

import typer

import armour
from armour import __version__, files
from armour.cli import completion, options
from armour.cli.console import progress, show, show_json
from armour.cli.folders import scenario_paths
from armour.cli.runner import check_outputs, propose, read_each, show_answer, source_word, write
from armour.errors import restated
from armour.files import shell_line
from armour.reporting.table import Table, VerdictLine
from armour.reporting.views import library as views
from armour.scenario.library import search_library
from armour.scenario.scenario import scenario_schema

WORDS = "A name, or words of names and descriptions, or a kind, such as metals."
SOURCES = "Copy the shipped file of this name; for files or folders of scenarios, write a suite that watches them."
# First line of a scenario, by which editors find the schema to check it; see docs/howto/schema.md.
SCHEMA_LINE = b"#:schema ./scenario.schema.json\n"


def library(
    words: list[str] | None = options.argument("WORDS", WORDS, None, words=completion.entries),
    as_json: bool = options.AS_JSON,
) -> None:
    """List or search rounds, materials and threats.

    Without words, all entries are listed. Case does not matter.

    If a single entry is found, it is shown with the source of every value.

    Examples
    --------
    armour library
    armour library SiC
    armour library metals
    armour library 7.62 steel
    """
    found = search_library(words or ())
    items, data = dict[str, dict[str, Any]](), dict[str, dict[str, Any]]()
    for kind, name, item in found:
        items.setdefault(kind, {})[name] = item
        data.setdefault(kind, {})[name] = item.model_dump() if kind == "threat" else item.to_dict()
    tables: list[Table | str] = [*views.tables_by_kind(items)]
    if len(found) == 1:
        [(kind, name, item)] = found
        tables = [*tables, f"source: {item.source}"] if kind == "threat" else views.entry_tables(item)
        tables.insert(0, VerdictLine(f"{name} ({kind})"))
    show_answer(data, tables, as_json=as_json)


def init(
    file: Path = typer.Argument(Path("scenario.toml"), metavar="FILE", help="File to write to."),
    sources: list[str] | None = options.text(SOURCES, "--from", metavar="NAME", words=completion.shipped_names),
    names: bool = options.flag("List the shipped scenarios, suites, tables of tests and notebooks.", "--list"),
    force: bool = options.FORCE,
) -> None:
    """Write a scenario, suite, table or notebook to start from.

    Examples
    --------
    armour init mine.toml
    armour init mine.toml --from paper/fig9_4mm --force
    armour init suite.toml --from wilkins --from catalogue
    """
    if names:
        show(*views.shipped_tables())
        return
    suites = files.shipped_suites()
    shipped = files.shipped_files("scenarios", ".toml") | suites | files.shipped_tests() | files.shipped_notebooks()
    source, *others = sources or ["template"]
    if others or source not in shipped:
        _init_suite(file, [source, *others], shipped, force=force)
        return
    ending = shipped[source].suffix
    hint = f"; to copy the shipped one: --from {file}" * (str(file) in shipped)
    with restated(lambda problem: problem._replace(message=problem.message + hint)):
        check_outputs((file, (ending,)), force=force)
    is_scenario = ending == ".toml" and source not in suites
    write({file: lambda _: SCHEMA_LINE * is_scenario + shipped[source].read_bytes()})
    if ending == ".toml":
        command = ["armour", "check" if is_scenario else "validate", source_word(file)]
        propose(shell_line([*command, *["--update"] * (source == "regression")]))
    elif ending == ".ipynb":
        propose(shell_line(["jupyter", "lab", source_word(file)]))


def _init_suite(file: Path, sources: Sequence[str], shipped: Mapping[str, Path], *, force: bool) -> None:
    """Write a suite that watches the scenarios of `sources`: files, folders of them, or names of `shipped` ones.

    The suite names files relative to its folder.
    """
    from armour.validation.new_suite import new_suite

    def read(path: Path) -> armour.Scenario:
        files.located(path, shipped)  # refuses what is missing, and names what is like it
        return armour.load_scenario(path)

    paths = scenario_paths([*map(Path, sources)])
    scenarios = read_each(paths, read)
    check_outputs((file, (".toml",)), inputs=scenarios, force=force)
    names = [relpath(path, file.parent) if path.exists() else path for path in paths]
    named = {Path(name).as_posix(): scenario for name, scenario in zip(names, scenarios, strict=True)}
    with progress("scenarios", len(named)) as count:
        text = new_suite(named, count)
    write({file: lambda _: text})
    propose(shell_line(["armour", "validate", source_word(file), "--update"]))


def schema() -> None:
    """Print the JSON Schema of a scenario.

    Editors use it to complete and check scenario files.

    Examples
    --------
    armour schema
    """
    show_json({**scenario_schema(), "$comment": f"made by armour {__version__}"})
