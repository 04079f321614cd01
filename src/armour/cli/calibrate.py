"""``armour calibrate``."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from armour.cli.options import AsJson, Changes, PlotFile, ScenarioFile, output
from armour.cli.runner import Answer, read_scenario, run, say_if_compiling


def calibrate(
    tests: Annotated[
        Path,
        typer.Argument(metavar="TESTS", help="CSV file of tests: inputs and measured values.", show_default=False),
    ],
    scenario: ScenarioFile,
    fit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="INPUT",
            help="Input to fit, ceramic.flow_stress_GPa by default; may be given several times.",
            show_default=False,
        ),
    ] = None,
    law: Annotated[
        Literal["constant", "linear", "proportional", "thicknesses"],
        typer.Option(
            metavar="LAW",
            help="Ceramic flow stress: constant; linear in or proportional to the ceramic thickness; "
            "or linear in both thicknesses (thicknesses).",
        ),
    ] = "constant",
    library: Annotated[
        Path | None, output("--write", "Write a library file with the fitted entries.", "LIB.toml")
    ] = None,
    plot: PlotFile = None,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Fit model inputs to tests."""
    from armour.reporting.tables.statistics import calibration_tables
    from armour.statistics.calibration import calibrate as find
    from armour.statistics.fitted_library import library_text
    from armour.statistics.flow_stress_laws import FLOW_STRESS
    from armour.statistics.test_data import read_tests

    def answer() -> Answer:
        loaded = read_scenario(scenario, changes)
        read = read_tests(tests, loaded)
        say_if_compiling()
        result = find(read, loaded, fit or [FLOW_STRESS], law)
        return Answer(
            data=result.to_dict,
            tables=lambda: calibration_tables(result),
            title=loaded.title,
            files=[lambda: library_text(result, read, loaded)],
            chart=lambda charts: charts.calibration_chart(result, loaded.title),
        )

    run(answer, reads=[tests, scenario], writes=[library], plot=plot, as_json=as_json)
