"""``armour sweep``."""

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from armour.cli.console import rate, say
from armour.cli.options import AsJson, Changes, PlotFile, ScenarioFile
from armour.cli.runner import Answer, read_scenario, run, say_if_compiling
from armour.errors import InputError, Problem

if TYPE_CHECKING:
    from armour.sweeps.cases import Cases, Grid

# Named here as well because the help may not import what computes them.
QUANTITIES = (
    "outcome",
    "residual_velocity_m_s",
    "residual_mass_g",
    "residual_length_mm",
    "velocity_lost_percent",
    "mass_lost_percent",
    "penetration_depth_mm",
    "bulge_height_mm",
    "plug_velocity_m_s",
    "duration_us",
    "areal_density_kg_m2",
    "ballistic_limit_m_s",
    "required_ceramic_thickness_mm",
    "required_backing_thickness_mm",
    "required_total_thickness_mm",
    "required_areal_density_kg_m2",
)


def sweep(
    scenario: ScenarioFile,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="Table to write, .csv or .parquet.")],
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUES",
            help="Key of the scenario and its values, as MIN:MAX:STEP or V,V,...; may be given several times, which "
            "spans a grid.",
            show_default=False,
        ),
    ] = None,
    cases: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="CSV file of cases in place of --over: keys as its header.", show_default=False
        ),
    ] = None,
    quantities: Annotated[
        str, typer.Option(metavar="NAME,...", help=f"Quantities to compute: {', '.join(QUANTITIES)}.")
    ] = "ballistic_limit_m_s",
    plot: PlotFile = None,
    threads: Annotated[
        int | None, typer.Option(min=1, help="Number of threads; by default one per core.", show_default=False)
    ] = None,
    scheduler: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS",
            help='Compute on the Dask cluster at this address; "local" starts one.',
            show_default=False,
        ),
    ] = "",
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Compute quantities over a grid or a table of cases; resume if interrupted."""
    from armour.sweeps.checkpoint import read_table
    from armour.sweeps.dask import connected, on_cluster
    from armour.sweeps.sweep import in_process
    from armour.sweeps.sweep import sweep as compute_rows

    def answer() -> Answer:
        loaded = read_scenario(scenario, changes)
        source = _source(over or [], cases)
        names = [name.strip() for name in quantities.split(",")]
        if plot is not None:
            _check_plot(source, names)
        say_if_compiling()
        with connected(scheduler) if scheduler else nullcontext() as client, rate("rows", source.count) as count:
            compute = in_process(threads) if client is None else on_cluster(client)
            rows = compute_rows(loaded, source, names, output, compute=compute, on_chunk=lambda n, _before: count(n))
        say(f"wrote {output}: {rows} rows")
        return Answer(
            data=lambda: {"rows": rows, "output": str(output)},
            tables=tuple,
            chart=lambda charts: charts.sweep_chart(read_table(output), source.keys, names[0], loaded),
        )

    run(answer, reads=[scenario, cases], makes=[output], plot=plot, as_json=as_json)


def _source(over: list[str], cases: Path | None) -> "Grid | Cases":
    """Return the rows to compute."""
    from armour.sweeps.cases import Cases, Grid, axis_of

    if (cases is None) == (not over):
        raise InputError([Problem("sweep", "--over", "must be given, or --cases, and not both")])
    return Grid(tuple(axis_of(text) for text in over)) if cases is None else Cases(cases)


def _check_plot(source: "Grid | Cases", names: list[str]) -> None:
    from armour.sweeps.cases import Grid

    if not isinstance(source, Grid) or len(source.axes) not in (1, 2) or names[0] == "outcome":
        message = "draws the first quantity, a number, over one or two --over"
        raise InputError([Problem("sweep", "--plot", message)])
