"""Make the standard streams such that nothing fails to be printed."""

import codecs
import os
import sys
from io import TextIOWrapper

# Replacements for characters of rules and units that the encoding of a stream lacks, as that of a pipe on Windows.
REPLACEMENTS = {"\N{MULTIPLICATION SIGN}": "x", "─": "-", "²": "2", "³": "3", "µ": "u", "±": "+-", "°": " deg"}


def open_streams() -> None:
    """Open standard streams that are closed on the null device; let the others replace what they cannot encode."""
    codecs.register_error("plain", plain)
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode))
        elif isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="plain")


def plain(error: UnicodeError) -> tuple[str, int]:
    """Replace characters that an encoding lacks, and return where to go on; an error handler for `codecs`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(REPLACEMENTS.get(character, "?") for character in error.object[error.start : error.end]), error.end
