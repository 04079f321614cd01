"""The commands of the program, with examples."""

from collections.abc import Callable
from typing import Annotated

import typer

from armour import MODEL_VERSION, __version__
from armour.cli import (
    ballistic_limit,
    calibrate,
    compare,
    figures,
    init,
    library,
    optimise,
    report,
    schema,
    sensitivity,
    simulate,
    sweep,
    uncertainty,
    v50,
    validate,
)
from armour.cli.options import flag
from armour.cli.runner import Command, Reporting

app = typer.Typer(
    cls=Reporting,
    no_args_is_help=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"armour {__version__}, model {MODEL_VERSION}")
        raise typer.Exit


@app.callback()
def _armour(
    version: Annotated[bool, flag("--version", "Show the version.", callback=_version, is_eager=True)] = False,
) -> None:
    """Predict whether a ceramic/metal light armour stops a projectile, and find the lightest that does.

    Exit codes: 0 done; 1 the question has no answer in the range given; 2 the input is wrong; 3 a check failed.
    """


W, P = "scenarios/wilkins.toml", "scenarios/paper"

# Each command with examples, which the tests run.
COMMANDS: dict[str, tuple[Callable[..., None], tuple[str, ...]]] = {
    "simulate": (
        simulate.simulate,
        (f"armour simulate {W}", f"armour simulate {W} --velocity 900 --history run.csv --plot run.svg"),
    ),
    "ballistic-limit": (
        ballistic_limit.ballistic_limit,
        (f"armour ballistic-limit {W}", f"armour ballistic-limit {W} --set armour.ceramic_thickness_mm=8 --json"),
    ),
    "optimise": (
        optimise.optimise,
        (
            f"armour optimise {P}/optimum_7.62mm_AP.toml --refine --plot optimum.svg",
            "armour optimise scenarios/catalogue.toml --csv front.csv",
        ),
    ),
    "sweep": (
        sweep.sweep,
        (f"armour sweep {W} --over armour.ceramic_thickness_mm=4:12:0.1 -o limits.csv --plot limits.svg",),
    ),
    "calibrate": (
        calibrate.calibrate,
        (f"armour calibrate scenarios/tests/wilkins.csv {W} --write mine.toml --plot fit.svg",),
    ),
    "uncertainty": (uncertainty.uncertainty, ("armour uncertainty scenarios/uncertain.toml --plot uncertainty.svg",)),
    "sensitivity": (sensitivity.sensitivity, (f"armour sensitivity {W} --plot sensitivity.svg",)),
    "v50": (v50.v50, (f"armour v50 scenarios/tests/shots.csv {W} --plot v50.svg",)),
    "report": (
        report.report,
        (f"armour report {P}/optimum_7.62mm_AP.toml -o report.html", "armour report suites/paper.toml -o suite.html"),
    ),
    "compare": (compare.compare, (f"armour compare {W}",)),
    "validate": (validate.validate, ("armour validate", "armour validate suites/paper.toml --junit junit.xml")),
    "figures": (figures.figures, ("armour figures . --only fig09",)),
    "init": (init.init, ("armour init mine.toml", "armour init mine.toml --from paper/fig9_4mm --force")),
    "schema": (schema.schema, ("armour schema",)),
}
for _name, (_command, _examples) in COMMANDS.items():
    app.command(_name, cls=Command, epilog="\n\n".join(("Examples:", *(f"`{example}`" for example in _examples))))(
        _command
    )
app.add_typer(library.app, name="library")
