"""Start the command line, and end it if it is interrupted."""

import codecs
import os
import signal
import sys
from collections.abc import MutableMapping
from io import TextIOWrapper
from typing import Any

# Replacements for characters of rules and units that the encoding of an output lacks.
REPLACEMENTS = {"\N{MULTIPLICATION SIGN}": "x", "─": "-", "²": "2", "³": "3", "µ": "u", "±": "+-", "°": " deg"}
# Beginnings of variables of the environment that slow libraries down, or make them print or fail.
IGNORED = ("EAGER_IMPORT", "NPY_", "NUMPY_", "SCIPY_", "TERMINAL_WIDTH", "TYPER_", "_TYPER_FORCE_")


def main() -> None:
    """Run the command line."""
    interruptions = []

    def interrupt(number: int, _frame: object) -> None:
        interruptions.append(number)
        raise KeyboardInterrupt

    for number in (signal.SIGINT, signal.SIGTERM):  # by a user, and by a program
        signal.signal(number, interrupt)
    sys.unraisablehook = _end_if_interrupted
    try:
        _open_streams()
        _settle(os.environ)
        from armour.cli.app import app

        app(prog_name="armour")
    except KeyboardInterrupt:
        _end()
    except Exception:
        if interruptions:  # pydantic may turn a KeyboardInterrupt into an error of its own
            _end()
        raise


def _open_streams() -> None:
    """Open standard streams that are closed on the null device, so that no file gets their descriptors.

    Those that are open replace characters that their encodings lack.
    """
    codecs.register_error("plain", _plain)
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8"))
        elif isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="plain")


def _plain(error: UnicodeError) -> tuple[str, int]:
    """Replace characters that an encoding lacks, and return where to go on; an error handler for `codecs`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(REPLACEMENTS.get(character, "?") for character in error.object[error.start : error.end]), error.end


def _settle(environment: MutableMapping[str, str]) -> None:
    """Remove the variables of the environment that libraries, but not this program, would take as settings.

    An empty one, as of an unset variable of CI, counts as not set, and so does a size of the terminal that is none.
    """
    for name, value in [*environment.items()]:
        is_no_size = name in ("COLUMNS", "LINES") and not (value.isascii() and value.isdecimal() and len(value) < 5)
        if not value or is_no_size or name.startswith(IGNORED):
            del environment[name]
    # Else the processes that --scheduler local starts would import modules from the current folder.
    environment["PYTHONSAFEPATH"] = "1"
    # Matrices are small, so threads for linear algebra would only slow down the start, by a fifth of numpy's.
    environment.setdefault("OPENBLAS_NUM_THREADS", "1")


def _end_if_interrupted(lost: Any) -> None:
    """End if an interruption came in a destructor or a callback, where Python cannot raise it.

    `lost` describes the exception that was lost; it is the argument of `sys.unraisablehook`.
    """
    if isinstance(lost.exc_value, KeyboardInterrupt):
        _end()
    sys.__unraisablehook__(lost)


def _end() -> None:
    """End an interrupted process at once: there is nothing to clean up."""
    try:
        os.write(2, b"interrupted\n")
    finally:
        os._exit(130)
