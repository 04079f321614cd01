"""Start the command line, and end it if it is interrupted."""

import os
import signal
import sys

from armour.cli.streams import open_streams


def main() -> None:
    """Run the command line."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices are small: more threads would only start slowly
    os.environ.pop("SOURCE_DATE_EPOCH", None)  # outputs have no date, but libraries fail on an empty or wrong one
    for number in (signal.SIGINT, signal.SIGTERM):  # which a shell may ignore, or end without removing unfinished files
        signal.signal(number, signal.default_int_handler)
    open_streams()
    try:
        from armour.cli.app import app

        app(prog_name="armour")
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)
