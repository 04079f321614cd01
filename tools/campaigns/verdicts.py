"""Ask every way out for the verdict on random armours with random requirements, and compare with a plain rule.

python -m tools.campaigns "verdicts --armours 100"
"""

import tempfile
from collections import Counter
from pathlib import Path

from tests.helpers.verdicts import WORDS, on_pages, rule, ways
from tools.campaigns.verdict import asked, verdict

# Pages that Chromium opens at once.
AT_ONCE = 12


def main() -> int:
    """Print how many armours had each verdict, and how many ways out gave another one."""
    options = asked(__doc__, armours=150, seed=1_000)
    seeds = range(options.seed, options.seed + options.armours)
    said = Counter[str]()
    with tempfile.TemporaryDirectory(prefix="campaign-") as name:
        for at in range(0, len(seeds), AT_ONCE):
            some = seeds[at : at + AT_ONCE]
            answers = [(seed, *answer) for seed in some for answer in ways(seed, Path(name))]
            answers += [(seed, "page", agrees) for seed, agrees in on_pages(some, Path(name)).items()]
            said.update("another" if not agrees else "page" if way == "page" else "right" for _, way, agrees in answers)
            for seed, way, _ in filter(lambda answer: not answer[2], answers):
                print(f"seed {seed}: {way} differs from {rule(seed)!r}", flush=True)
    found = Counter(map(rule, seeds))
    words = ", ".join(f"{found[word]:,} {word}" for word in WORDS)
    text = f"{words}; {said.total():,} answers, {said['page']:,} of them on pages, {said['another']} wrong"
    return verdict(text, right=not said["another"] and all(found[word] for word in WORDS))
