"""The command line: parse, call the library, print, exit code."""

import sys
from io import TextIOWrapper

from armour.cli.app import app

__all__ = ["main"]


def main() -> None:
    """Run the command line."""
    # What an encoding such as ASCII does not have, µ for one, is escaped.
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    app(prog_name="armour")
