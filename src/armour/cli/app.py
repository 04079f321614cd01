"""The commands together."""

from typing import Annotated

import typer

from armour import __version__
from armour.cli import (
    ballistic_limit,
    calibrate,
    compare,
    figures,
    init,
    library,
    optimise,
    report,
    sensitivity,
    simulate,
    sweep,
    uncertainty,
    v50,
    validate,
)
from armour.cli.common import Reporting

app = typer.Typer(
    cls=Reporting,
    no_args_is_help=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"armour {__version__}")
        raise typer.Exit


@app.callback()
def _armour(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Tell whether a ceramic/metal armour stops a projectile, up to which velocity, and which is the lightest to do so.

    Exit codes: 0 done; 1 the question has no answer in the range given; 2 the input is wrong;
    3 a check failed.
    """


app.command("simulate")(simulate.simulate)
app.command("ballistic-limit")(ballistic_limit.ballistic_limit)
app.command("optimise")(optimise.optimise)
app.command("sweep")(sweep.sweep)
app.command("calibrate")(calibrate.calibrate)
app.command("uncertainty")(uncertainty.uncertainty)
app.command("sensitivity")(sensitivity.sensitivity)
app.command("v50")(v50.v50)
app.command("report")(report.report)
app.command("compare")(compare.compare)
app.command("validate")(validate.validate)
app.command("figures")(figures.figures)
app.add_typer(library.app, name="library")
app.command("init")(init.init)
