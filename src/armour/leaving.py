"""What leaves with version 3 and says so when it is used; docs/stability.md announces all that leaves."""

from warnings import warn

_TESTS_TO_SPREAD = "spread tests over the thicknesses that you will use, on two back plates at least"
_TESTS_OF_PRIOR = "add the tests behind the prior to the table"
_EACH_LAW = "fit the laws one by one and compare their leave-one-out errors"
_WORDS = "then it is armour library WORDS"

# Names of commands, options, keys and of Python, with what to use in their place, if anything.
LEAVING = {
    "plan tests": _TESTS_TO_SPREAD,
    "compile": "there, armour is compiled when it is built",
    "calibrate --prior": _TESTS_OF_PRIOR,
    "calibrate --law all": _EACH_LAW,
    "library show": _WORDS,
    "library projectiles": _WORDS,
    "library ceramics": _WORDS,
    "library threats": _WORDS,
    "library metals": _WORDS,
    "table.rivals": "compare other predictions with the values of validate --json",
    "plan_tests": _TESTS_TO_SPREAD,
    "calibrate(prior=True)": _TESTS_OF_PRIOR,
    'calibrate(law="all")': _EACH_LAW,
    "replacing equations": "there, with armour.equations(...) takes its place",
    "armour.LawFit": "",
    "armour.PlannedTest": "",
    "armour.PlannedTests": "",
    "armour.ResidualVelocityFit": "",
}


def leaving(what: str) -> str:
    """Return what is said when something is used that leaves: what to use in its place."""
    return ": ".join(filter(None, (f"{what} leaves with version 3", LEAVING[what])))


def warn_leaving(what: str, stacklevel: int) -> None:
    """Warn a program that it uses something that leaves; `stacklevel` is that of `warnings.warn` in the caller."""
    warn(leaving(what), DeprecationWarning, stacklevel=stacklevel + 1)
