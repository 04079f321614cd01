"""How a campaign ends: a line for the page of results, and an exit code."""

RESULT, WRONG = "result: ", 3


def verdict(found: str, *, right: bool) -> int:
    """Print what a campaign has found; return the exit code, 3 if it is not as it should be."""
    print(f"{RESULT}{found}", flush=True)
    return 0 if right else WRONG
