"""``armour sweep``."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from armour.cli.runner import (
    AsJson,
    Changes,
    PlotFile,
    ScenarioFile,
    check_outputs,
    console,
    print_json,
    read_scenario,
    tell_of_compiling,
    write_plot,
)
from armour.errors import InputError, Problem

if TYPE_CHECKING:
    from armour.sweeps.cases import Cases, Grid
    from armour.sweeps.sweep import OnChunk


def sweep(
    scenario: ScenarioFile,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="Table to write, .csv or .parquet.")],
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUES",
            help="A key of the scenario and its values, as MIN:MAX:STEP or V,V,...; several span a grid.",
            show_default=False,
        ),
    ] = None,
    cases: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV file of cases instead, keys as its header.", show_default=False),
    ] = None,
    quantities: Annotated[
        str, typer.Option(metavar="NAME,...", help="What to compute of each.")
    ] = "ballistic_limit_m_s",
    plot: PlotFile = None,
    threads: Annotated[
        int | None, typer.Option(min=1, help="Threads; left out: one per core.", show_default=False)
    ] = None,
    scheduler: Annotated[
        str,
        typer.Option(metavar="ADDRESS", help='Compute on a Dask cluster; "local" starts one.', show_default=False),
    ] = "",
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Compute quantities over grids of values, or a table of cases; interrupted, it goes on where it stopped."""
    from armour.sweeps.dask import connected, on_cluster
    from armour.sweeps.sweep import in_process
    from armour.sweeps.sweep import sweep as run_sweep

    check_outputs(output, plot=plot, source=scenario)
    loaded = read_scenario(scenario, changes)
    source = _source(over or [], cases)
    names = [name.strip() for name in quantities.split(",")]
    if plot is not None:
        _check_plot(source, names)
    tell_of_compiling()
    with connected(scheduler) if scheduler else nullcontext() as client, _progress(source.count) as show:
        compute = in_process(threads) if client is None else on_cluster(client)
        rows = run_sweep(loaded, source, names, output, compute=compute, on_chunk=show)
    if as_json:
        print_json({"rows": rows, "output": str(output)})
    print(f"wrote {output}: {rows} rows", file=sys.stderr)
    if plot is not None:
        from armour.reporting.plots import sweep_figure
        from armour.sweeps.checkpoint import read_table

        write_plot(plot, sweep_figure(read_table(output), source.keys, names[0], loaded))


def _source(over: list[str], cases: Path | None) -> "Grid | Cases":
    """The rows asked for."""
    from armour.sweeps.cases import Cases, Grid, axis_of

    if (cases is None) == (not over):
        raise InputError([Problem("sweep", "--over", "must be given, or --cases, and not both")])
    return Grid(tuple(axis_of(text) for text in over)) if cases is None else Cases(cases)


def _check_plot(source: "Grid | Cases", names: list[str]) -> None:
    from armour.sweeps.cases import Grid

    if not isinstance(source, Grid) or len(source.axes) not in (1, 2) or names[0] == "outcome":
        message = "draws the first quantity, a number, over one or two --over"
        raise InputError([Problem("sweep", "--plot", message)])


@contextmanager
def _progress(total: int) -> Iterator["OnChunk"]:
    """A progress bar with rate and time left on a terminal, nothing elsewhere."""
    if not sys.stderr.isatty():
        yield lambda _rows, _before: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"), TimeRemainingColumn())
    with Progress(*columns, console=console(stderr=True), transient=True) as bar:
        task = bar.add_task("rows", total=total, rate="compiling or reading compiled code")

        def show(rows: int, _before: bool) -> None:
            bar.advance(task, rows)
            speed = bar.tasks[task].speed
            bar.update(task, rate=f"{speed:,.0f} rows/s" if speed else "")

        yield show
