"""What is asked of a campaign, and how it ends: a line for the page of results, and an exit code."""

from argparse import ArgumentParser, Namespace

RESULT, WRONG = "result: ", 3


def asked(words: str | None, **usual: int) -> Namespace:
    """Return the numbers that options ask for, such as ``--trials``, or the usual ones."""
    parser = ArgumentParser(description=words)
    for name, number in usual.items():
        parser.add_argument(f"--{name}", type=int, default=number)
    return parser.parse_args()


def verdict(found: str, *, right: bool) -> int:
    """Print what a campaign has found; return the exit code, 3 if it is not as it should be."""
    print(f"{RESULT}{found}", flush=True)
    return 0 if right else WRONG
