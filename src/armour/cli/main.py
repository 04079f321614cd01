"""Start the command line, and end it if it is interrupted."""

import atexit
import codecs
import gc
import os
import signal
import sys
from collections.abc import Callable, MutableMapping
from io import TextIOWrapper
from typing import Any

# Replacements for characters of rules and units that the encoding of an output lacks.
REPLACEMENTS = {"\N{MULTIPLICATION SIGN}": "x", "─": "-", "²": "2", "³": "3", "µ": "u", "±": "+-", "°": " deg"}
# Beginnings of variables of the environment that slow libraries down, or make them print or fail.
IGNORED = ("EAGER_IMPORT", "NPY_", "NUMPY_", "SCIPY_", "TERMINAL_WIDTH", "TYPER_", "_TYPER_FORCE_")


def main() -> None:
    """Run the command line."""
    # Before and after a command, end at once: there is nothing to clean up, and an import could lose an exception.
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
        if interruptions:  # pydantic may turn a KeyboardInterrupt into an error of its own
            _end()
        raise


def _run(interrupt: Callable[[int, object], None]) -> None:
    """Run the command line; `interrupt` handles interruptions while a command runs."""
    try:
        _open_streams()
        codecs.register_error("plain", _plain)
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, TextIOWrapper):
                stream.reconfigure(errors="plain")
        _settle(os.environ)
        # Pydantic looks for plugins among all installed packages, which takes a while.
        os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
        # Else the processes that --scheduler local starts would import modules from the current folder.
        os.environ["PYTHONSAFEPATH"] = "1"
        # Matrices are small, so threads for linear algebra would only slow down the start.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        # Nearly all objects that a start creates live to the end: collecting garbage would take a quarter of its time.
        gc.set_threshold(10_000)
        atexit.register(gc.freeze)
        from armour.cli.app import app

        _when_interrupted(interrupt)
        app(prog_name="armour")
    except OSError as error:
        _give_up(error)
    finally:
        _when_interrupted(_end)


def _settle(environment: MutableMapping[str, str]) -> None:
    """Remove the variables of the environment that libraries, but not this program, would take as settings.

    An empty one, as of an unset variable of CI, counts as not set, and so does a size of the terminal that is none.
    """
    for name, value in [*environment.items()]:
        is_no_size = name in ("COLUMNS", "LINES") and not (value.isascii() and value.isdecimal() and len(value) < 5)
        if not value or is_no_size or name.startswith(IGNORED):
            del environment[name]


def _plain(error: UnicodeError) -> tuple[str, int]:
    """Replace characters that an encoding lacks, and return where to go on; an error handler for `codecs`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(REPLACEMENTS.get(character, "?") for character in error.object[error.start : error.end]), error.end


def _when_interrupted(act: Any) -> None:
    """Set the handler of the signals by which a user interrupts the process (SIGINT) or a program ends it (SIGTERM)."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, act)


def _end(*_signal: object) -> None:
    """End an interrupted process at once."""
    try:
        os.write(2, b"interrupted\n")
    finally:
        os._exit(130)


def _end_if_interrupted(lost: Any) -> None:
    """End if an interruption came in a callback or a compiled module, where Python cannot raise it.

    `lost` describes the exception that was lost; it is the argument of `sys.unraisablehook`.
    """
    if isinstance(lost.exc_value, KeyboardInterrupt):
        _end()
    sys.__unraisablehook__(lost)


def _open_streams() -> None:
    """Open standard streams that are closed on the null device, so that no file gets their descriptors."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8"))


def _give_up(error: OSError) -> None:
    """End with exit code 2 and the message of the operating system, such as that the disk is full."""
    from armour.cli.console import discard, say
    from armour.files import reason

    discard(sys.stdout)
    say(": ".join((str(error.filename or "standard output"), reason(error))))
    sys.exit(2)
