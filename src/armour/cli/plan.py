"""``armour plan``: what to test next."""

import typer

from armour.cli import plan_shots, plan_tests
from armour.cli.runner import Command, Reporting

app = typer.Typer(cls=Reporting, no_args_is_help=True)


@app.callback()
def _plan() -> None:
    """Plan tests: the next shot of a V50 firing, or which armours to test."""


for name, function, examples in (
    ("shots", plan_shots.plan_of_shots, plan_shots.EXAMPLES),
    ("tests", plan_tests.plan_of_tests, plan_tests.EXAMPLES),
):
    app.command(name, cls=Command, epilog="\n\n".join(("Examples:", *(f"`armour {each}`" for each in examples))))(
        function
    )
