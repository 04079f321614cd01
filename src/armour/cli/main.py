"""Start of the command line."""

import atexit
import codecs
import gc
import os
import signal
import sys
from collections.abc import Callable
from io import TextIOWrapper
from typing import Any

# What is printed in place of the characters of rules and units, where an encoding lacks them.
REPLACEMENTS = {"\N{MULTIPLICATION SIGN}": "x", "─": "-", "²": "2", "³": "3", "µ": "u", "±": "+-", "°": " deg"}


def main() -> None:
    """Run the command line."""
    # Before and after a command there is nothing to clean up, and an exception could be lost in an import.
    _when_interrupted(_end)
    sys.unraisablehook = _end_if_interrupted
    interruptions = []

    def interrupt(number: int, _frame: object) -> None:
        interruptions.append(number)
        raise KeyboardInterrupt

    try:
        _run(interrupt)
    except KeyboardInterrupt:
        _end()
    except Exception:
        if interruptions:  # pydantic, where it builds a schema or serializes, makes its own error of one
            _end()
        raise


def _run(interrupt: Callable[[int, object], None]) -> None:
    """Run the command line; an interruption may come anywhere."""
    try:
        _open_streams()
        codecs.register_error("plain", _plain)
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, TextIOWrapper):
                stream.reconfigure(errors="plain")
        # Pydantic looks for plugins among all installed packages, which takes a while.
        os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
        # A process started for --scheduler local would import modules of the current folder.
        os.environ["PYTHONSAFEPATH"] = "1"
        # The matrices are small: threads for linear algebra would only make every start slower.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        # Nearly all that a start creates stays to the end: looking for garbage in it would take a quarter of the time.
        gc.set_threshold(10_000)
        atexit.register(gc.freeze)
        from armour.cli.app import app

        _when_interrupted(interrupt)
        app(prog_name="armour")
    except OSError as error:
        _give_up(error)
    finally:
        _when_interrupted(_end)


def _plain(error: UnicodeError) -> tuple[str, int]:
    """Return plain characters for those that the encoding of an output lacks."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(REPLACEMENTS.get(character, "?") for character in error.object[error.start : error.end]), error.end


def _when_interrupted(act: Any) -> None:
    """Set what happens when the user interrupts the process, or another process, such as a time limit, ends it."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, act)


def _end(*_signal: object) -> None:
    """End an interrupted process at once."""
    try:
        os.write(2, b"interrupted\n")
    finally:
        os._exit(130)


def _end_if_interrupted(lost: Any) -> None:
    """End if an interruption came in a callback or a compiled module, which lose exceptions."""
    if isinstance(lost.exc_value, KeyboardInterrupt):
        _end()
    sys.__unraisablehook__(lost)


def _open_streams() -> None:
    """Open closed streams on the null device, in their order, so that no file of a command takes their place."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8"))


def _give_up(error: OSError) -> None:
    """End with the message of the operating system, such as that of a full disk."""
    from armour.cli.console import discard, say
    from armour.files import reason

    discard(sys.stdout)
    say(": ".join((str(error.filename or "standard output"), reason(error))))
    sys.exit(2)
