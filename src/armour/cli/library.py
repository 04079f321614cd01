"""Commands on shipped data: list the library, copy files to start from, and print the schema."""

from collections.abc import Callable, Mapping, Sequence
from os.path import relpath
from pathlib import Path
from typing import Any

import typer

import armour
import armour.lazy as lazy
from armour import __version__
from armour.cli import completion
from armour.cli.console import progress, show, show_json
from armour.cli.folders import YES, scenario_paths
from armour.cli.options import AS_JSON, FORCE, argument, flag, option
from armour.cli.runner import check_outputs, propose, say_leaving, show_answer, source_word, write
from armour.errors import InputError, Problem, refuse
from armour.files import (
    located,
    shell_line,
    shipped_files,
    shipped_notebooks,
    shipped_suites,
    shipped_tests,
    wrong_ending,
)
from armour.reporting.table import Table

# Kinds of entries; each has a command, its plural, that lists them.
LISTED_KINDS = ("projectile", "ceramic", "threat", "metal")
# First line of a scenario, by which editors find the schema to check it; see docs/howto/schema.md.
SCHEMA_LINE = b"#:schema ./scenario.schema.json\n"
ONLY_TESTED = flag("List only entries for which tests provide a model error.", "--tested")


def list_library(ctx: typer.Context, tested: bool = ONLY_TESTED, as_json: bool = AS_JSON) -> None:
    """List projectiles, ceramics and threats; `armour library metals` lists the metals, which are many."""
    if ctx.invoked_subcommand is None:
        _list(LISTED_KINDS, tested=tested, as_json=as_json)


def section(kind: str) -> Callable[..., None]:
    """Return the command that lists the entries of a kind."""

    def listed(ctx: typer.Context, tested: bool = ONLY_TESTED, as_json: bool = AS_JSON) -> None:
        options = ctx.parent.params if ctx.parent is not None else {}
        say_leaving(f"library {kind}s")
        _list((kind,), tested=tested or options["tested"], as_json=as_json or options["as_json"])

    listed.__doc__ = f"List {kind}s."
    return listed


def _list(kinds: Sequence[str], *, tested: bool, as_json: bool) -> None:
    """List the entries of some kinds; with `tested`, only those for which tests provide a model error."""
    library, partners = lazy.shipped_library(), None
    data: dict[str, dict[str, Any]] = library.to_dict()
    threats = lazy.named_threats()
    if tested:
        partners = lazy.tested_with()
        tested_data: dict[str, dict[str, Any]] = {kind: {} for kind in data}
        for (kind, name), words in partners.items():
            tested_data[kind][name] = {**data[kind][name], "tested_with": list(words)}
        data = tested_data
        threats = {name: threat for name, threat in threats.items() if ("projectile", threat.projectile) in partners}
    data["threat"] = {name: threat.model_dump() for name, threat in threats.items()}
    tables: dict[str, Table | str] = {kind: lazy.library_table(library, kind, partners) for kind in library.entries}
    tables["threat"] = lazy.threat_table(threats)
    if len(kinds) > 1:
        tables["metal"] = f"{len(data['metal'])} metals: armour library metals{' --tested' * tested}"
    show_answer({kind: data[kind] for kind in kinds}, [tables[kind] for kind in kinds], as_json=as_json)


def show_entry(
    ctx: typer.Context,
    name: str = argument("NAME", "Name of the entry.", autocompletion=completion.entries),
    as_json: bool = AS_JSON,
) -> None:
    """Show an entry with the source of every value."""
    as_json = as_json or (ctx.parent is not None and ctx.parent.params["as_json"])
    if threat := lazy.named_threats().get(name):
        content = {"kind": "threat", "name": name, **threat.model_dump()}
        show_answer(
            content, (lazy.threat_table({name: threat}), f"source: {threat.source}"), as_json=as_json, heading=[name]
        )
    else:
        for entry in lazy.shipped_library().find(name):
            heading = [f"{entry.name} ({entry.kind})"]
            show_answer(entry.to_dict(), lazy.entry_tables(entry), as_json=as_json, heading=heading)
    say_leaving("library show")


def init(
    file: Path = typer.Argument(Path("scenario.toml"), metavar="FILE", help="File to write to."),
    sources: list[str] | None = option(
        "Copy the shipped scenario, suite, table of tests or notebook of this name. For a file or a folder of "
        "scenarios, or if repeated, write a suite that watches these scenarios.",
        "--from",
        metavar="NAME",
        autocompletion=completion.shipped_names,
    ),
    names: bool = flag("List the shipped scenarios, suites, tables of tests and notebooks.", "--list"),
    yes: bool = YES,
    force: bool = FORCE,
) -> None:
    """Write a scenario, a suite, a table of tests or a notebook to start from."""
    if names:
        show(*lazy.shipped_tables())
        return
    suites = shipped_suites()
    shipped = {**shipped_files("scenarios", ".toml"), **suites, **shipped_tests(), **shipped_notebooks()}
    source, *others = sources or ["template"]
    if others or source not in shipped:
        _init_suite(file, [source, *others], shipped, yes=yes, force=force)
        return
    ending = shipped[source].suffix
    check_outputs(file, force=force)
    hint = f"; to copy the shipped one: --from {file}" * (str(file) in shipped)
    refuse(problem._replace(message=problem.message + hint) for problem in wrong_ending(file, (ending,)))
    is_scenario = ending == ".toml" and source not in suites
    write({file: lambda _: SCHEMA_LINE * is_scenario + shipped[source].read_bytes()})
    if ending == ".toml":
        command = ["armour", "check" if is_scenario else "validate", source_word(file)]
        propose(shell_line([*command, *["--update"] * (source == "regression")]))
    elif ending == ".ipynb":
        propose(shell_line(["jupyter", "lab", source_word(file)]))


def _init_suite(file: Path, sources: Sequence[str], shipped: Mapping[str, Path], *, yes: bool, force: bool) -> None:
    """Write a suite that watches scenarios; files among them are relative to its folder, and others are `shipped`."""
    refuse(wrong_ending(file, (".toml",)))
    scenarios: dict[str, armour.Scenario] = {}
    problems: list[Problem] = []
    for path in scenario_paths([*map(Path, sources)], yes=yes):
        try:
            located(path, shipped)  # refuses what is missing, and names what is like it
            name = Path(relpath(path, file.parent)) if path.exists() else path
            scenarios[name.as_posix()] = armour.load_scenario(path)
        except InputError as error:
            problems += error.problems
    refuse(dict.fromkeys(problems))
    check_outputs(file, inputs=[path for loaded in scenarios.values() for path in lazy.files_of(loaded)], force=force)
    with progress("scenarios", len(scenarios)) as count:
        text = lazy.new_suite(scenarios, count)
    write({file: lambda _: text})
    propose(shell_line(["armour", "validate", source_word(file), "--update"]))


def schema() -> None:
    """Print the JSON Schema of a scenario.

    Editors use it to complete and check scenario files.
    """
    show_json({**lazy.scenario_schema(), "$comment": f"made by armour {__version__}"})
