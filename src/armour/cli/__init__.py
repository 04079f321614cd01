"""The command line: parse, call the library, print, exit code."""

from armour.cli.app import app

__all__ = ["main"]


def main() -> None:
    """Run the command line."""
    app(prog_name="armour")
