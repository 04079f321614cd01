"""Start of the command line."""

import sys
from io import TextIOWrapper


def main() -> None:
    """Run the command line."""
    # What an encoding such as ASCII does not have, µ for one, is escaped.
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        from armour.cli.app import app

        app(prog_name="armour")
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        sys.exit(130)
