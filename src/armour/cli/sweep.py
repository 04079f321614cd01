"""``armour sweep``."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from os.path import exists
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from armour.analysis.quantities import QUANTITIES, REQUIRED, reads_of
from armour.cli import completion
from armour.cli.console import progress, say
from armour.cli.options import AsJson, Changes, Force, PlotFile, ScenarioFile, option
from armour.cli.runner import as_options, check_outputs, read_scenario, respond, say_if_compiling
from armour.errors import InputError, Problem

if TYPE_CHECKING:
    from armour.sweeps.cases import Cases, Grid
    from armour.sweeps.sweep import Plan

# Sweeps that take longer are announced.
ANNOUNCED_S = 10.0


def sweep(
    scenario: ScenarioFile,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="Table to write, .csv or .parquet.")],
    over: Annotated[
        list[str] | None,
        option(
            "Key of the scenario and its values, as MIN:MAX:STEP or V,V,...; repeat it to span a grid.",
            metavar="KEY=VALUES",
            autocompletion=completion.numbers,
        ),
    ] = None,
    cases: Annotated[
        Path | None,
        option(
            "CSV file of cases, instead of --over; its header names the keys, such as "
            "armour.ceramic, and each row gives their values, such as SiC.",
            metavar="FILE",
        ),
    ] = None,
    quantities: Annotated[
        str,
        option(
            "Quantities to compute, of those listed below; ballistic limit by default.",
            metavar="NAME,...",
            autocompletion=completion.quantities,
        ),
    ] = "ballistic_limit_m_s",
    plot: PlotFile = None,
    force: Force = False,
    threads: Annotated[
        int | None,
        typer.Option(min=1, metavar="NUMBER", help="Threads, at least 1; by default one per core.", show_default=False),
    ] = None,
    scheduler: Annotated[
        str, option('Compute on the Dask cluster at this address; "local" starts one.', metavar="ADDRESS")
    ] = "",
    yes: Annotated[bool, option("Go on where a sweep takes hours, or more space than is free.", "--yes")] = False,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Compute quantities over a grid or a table of cases; resume if interrupted."""
    from armour.reporting.views.sweep import sweep_chart
    from armour.scenario.scenario import heading
    from armour.sweeps.cluster import connected, workers_of
    from armour.sweeps.store import parts_of, read_table
    from armour.sweeps.sweep import subject_of, write_sweep

    begun = exists(parts_of(output))
    check_outputs(None if begun else output, plot=plot, updated=output if begun else None, force=force)
    names = [name.strip() for name in quantities.split(",")]
    reads = reads_of(name for name in names if name in QUANTITIES)
    loaded = read_scenario(scenario, changes, ("impact.projectile", "armour", *reads), what="the sweep")
    with as_options("sweep"):
        source = _source(over or [], cases)
    if plot is not None:
        _check_plot(source, names)
    say_if_compiling()
    with (
        ExitStack() as stack,
        progress("rows", source.count) as count,
        as_options("sweep"),
    ):
        workers = stack.enter_context(workers_of(stack.enter_context(connected(scheduler)))) if scheduler else None
        rows = write_sweep(
            loaded,
            source,
            names,
            output,
            replace=force,
            workers=workers,
            threads=threads,
            on_chunk=lambda n, stored: count(n, stored=stored),
            approve=lambda plan: _approve(plan, yes),
            tell=say,
        )
    say(f"wrote {output}: {rows} rows", *_notes(names, drawn=plot is not None))
    respond(
        {"rows": rows, "output": str(output)},
        (),
        as_json=as_json,
        of=heading(subject_of(loaded, source, names), loaded.title),
        plot=plot,
        chart=lambda: sweep_chart(read_table(output), source.keys, names[0], loaded),
    )


def _notes(names: list[str], *, drawn: bool) -> Iterator[str]:
    """Yield what the quantities of a sweep mean, and which is drawn."""
    required = [name for name in names if QUANTITIES[name].on_grid]
    if required:
        yield f"note: {', '.join(required)}: {REQUIRED}"
    if drawn and len(names) > 1:
        yield f"note: --plot draws {names[0]} alone, the first of --quantities"


def _source(over: list[str], cases: Path | None) -> "Grid | Cases":
    """Return the rows to compute."""
    from armour.sweeps.cases import Cases

    if (cases is None) == (not over):
        raise InputError([Problem("sweep", "", "give either --over or --cases")])
    if cases is not None:
        return Cases(cases)
    return grid_of("--over", over)


def grid_of(option: str, texts: Sequence[str]) -> "Grid":
    """Return the grid of the values of an option, and warn of ranges whose end is left out."""
    from armour.sweeps.cases import Grid, axis_of

    axes = tuple(map(axis_of, texts))
    for axis in axes:
        if axis.omission:
            say(f"warning: {option} {axis.key}: {axis.omission}")
    return Grid(axes)


def _approve(plan: "Plan", yes: bool) -> None:
    """Announce a sweep that is not over at once; refuse a large one without ``--yes``."""
    if plan.is_large and not yes:
        raise InputError([Problem("sweep", "", f"{plan}; --yes to go on")])
    if plan.seconds > ANNOUNCED_S:
        say(str(plan))


def _check_plot(source: "Grid | Cases", names: list[str]) -> None:
    from armour.sweeps.cases import Grid

    found = len(source.axes) if isinstance(source, Grid) else 0
    if found not in (1, 2):
        raise InputError([Problem("sweep", "", f"--plot needs one or two --over keys, found {found or 'none'}")])
    if names[0] == "outcome":
        raise InputError([Problem("sweep", "", "--plot cannot draw outcome, which is not a number")])
