"""The commands of the program, with examples."""

from collections.abc import Callable
from typing import Annotated

import typer

from armour import MODEL_VERSION, __version__
from armour.analysis.quantities import QUANTITIES, REQUIRED
from armour.cli.console import emit
from armour.cli.experiments import calibrate, plan_shots, plan_tests, v50
from armour.cli.figures import figures
from armour.cli.library import app as library
from armour.cli.options import option
from armour.cli.report import report
from armour.cli.runner import Command, Question, Reporting
from armour.cli.scenario_commands import ballistic_limit, compare, optimise, sensitivity, simulate, uncertainty
from armour.cli.scenario_files import init, schema
from armour.cli.sweep import sweep
from armour.cli.validate import validate

app = typer.Typer(
    cls=Reporting,
    no_args_is_help=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        emit(f"armour {__version__}, model {MODEL_VERSION}\n")
        raise typer.Exit


@app.callback()
def _armour(
    version: Annotated[bool, option("Show the version.", "--version", callback=_version, is_eager=True)] = False,
) -> None:
    """Predict whether a ceramic/metal light armour stops a projectile, and find the lightest that does.

    Exit codes: 0 success; 1 the question has no answer in the given range; 2 invalid input; 3 a check of `validate`
    failed; 130 interrupted.
    """


plan = typer.Typer(cls=Reporting, no_args_is_help=True)


@plan.callback()
def _plan() -> None:
    """Plan tests: the next shot of a V50 firing, or which armours to test."""


W, P = "wilkins", "paper"
CERAMICS, PLATES = "armour.ceramic_thickness_mm=4:12:1", "armour.backing_thickness_mm=4:10:1"

# Each command with examples, which the tests run.
COMMANDS: dict[Callable[..., None], tuple[str, ...]] = {
    simulate: (f"simulate {W}", f"simulate {W} --velocity 900 --history run.csv --plot run.svg"),
    ballistic_limit: (f"ballistic-limit {W}", f"ballistic-limit {W} --set armour.ceramic_thickness_mm=8 --json"),
    optimise: (
        f"optimise {P}/optimum_7.62mm_AP --refine --plot optimum.svg",
        "optimise catalogue --csv front.csv",
    ),
    sweep: (f"sweep {W} --over armour.ceramic_thickness_mm=4:12:0.1 -o limits.csv --plot limits.svg",),
    calibrate: (
        f"calibrate wilkins.csv {W} --write calibrated.toml --plot fit.svg",
        f"calibrate wilkins.csv {W} --law backing --write-scenario fitted.toml",
    ),
    uncertainty: ("uncertainty uncertain --plot uncertainty.svg",),
    sensitivity: (f"sensitivity {W} --plot sensitivity.svg",),
    v50: (f"v50 shots.csv {W} --plot v50.svg",),
    report: (f"report {P}/optimum_7.62mm_AP -o report.html", "report paper -o suite.html"),
    compare: (f"compare {W}",),
    validate: ("validate", "validate paper --junit junit.xml"),
    figures: ("figures . --only fig09",),
    init: ("init mine.toml", "init mine.toml --from paper/fig9_4mm --force"),
    schema: ("schema",),
    plan_shots: (
        f"plan shots {W}",
        f"plan shots {W} firing.csv --result partial --plot plan.svg",
        f"plan shots {W} --simulate --true-v50-m-s 770 --true-scatter-m-s 15",
    ),
    plan_tests: (
        f"plan tests {W} --candidates {CERAMICS} --candidates {PLATES} --scatter-percent 3",
        f"plan tests {W} --candidates {CERAMICS} --tests wilkins.csv --law ceramic --csv next.csv --plot next.svg",
    ),
}
for _command, _examples in COMMANDS.items():
    _parts = ["Examples:", *(f"`armour {example}`" for example in _examples)]
    if _command is sweep:
        # As a text, since the column of descriptions is too narrow for the names.
        _parts[:0] = [f"Quantities: {', '.join(QUANTITIES)}.", f"required_...: {REQUIRED}."]
    _class = Question if hasattr(_command, "parameters") else Command
    _group, _name = (plan, _command.__name__[5:]) if _command in (plan_shots, plan_tests) else (app, _command.__name__)
    _group.command(_name.replace("_", "-"), cls=_class, epilog="\n\n".join(_parts))(_command)
app.add_typer(library, name="library")
app.add_typer(plan, name="plan")
