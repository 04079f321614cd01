"""What leaves with version 3 and says so when it is used; docs/stability.md announces all that leaves."""

from warnings import warn

# Names of commands, keys and of Python, with what to use in their place.
LEAVING = {
    "table.rivals": "compare other predictions with the values of validate --json",
}


def leaving(what: str) -> str:
    """Return what is said when something is used that leaves: what to use in its place."""
    return f"{what} leaves with version 3: {LEAVING[what]}"


def warn_leaving(what: str, stacklevel: int) -> None:
    """Warn a program that it uses something that leaves; `stacklevel` is that of `warnings.warn` in the caller."""
    warn(leaving(what), DeprecationWarning, stacklevel=stacklevel + 1)
