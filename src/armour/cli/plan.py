"""``armour plan``: what to test next."""

import typer

from armour.cli import plan_tests
from armour.cli.runner import Command, Reporting

app = typer.Typer(cls=Reporting, no_args_is_help=True)


@app.callback()
def _plan() -> None:
    """Plan tests: which armours to test."""


app.command(
    "tests", cls=Command, epilog="\n\n".join(("Examples:", *(f"`armour {text}`" for text in plan_tests.EXAMPLES)))
)(plan_tests.plan_of_tests)
