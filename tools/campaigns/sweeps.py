"""Kill sweeps, damage their rows, start two to one output, fill disks, kill workers: each ends right or with a message.

    python -m tools.campaigns.sweeps [NAME]...

runs the named campaigns, by default all; it counts how the trials ended, and exits with 3 if one ended wrong.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from itertools import count
from pathlib import Path
from unittest.mock import patch

from distributed import LocalCluster

from armour.cli.app import app
from armour.engine.cache import kernel
from armour.sweeps import sweep as sweeps
from armour.sweeps.store import Chunk, Store
from tests.helpers.cases import SCENARIOS
from tools.campaigns.verdict import verdict

OVER = ["--over", "armour.ceramic_thickness_mm=2:12:0.05", "--over", "impact.velocity_m_s=700:900:20"]
QUANTITIES = ("residual_velocity_m_s,outcome", "penetration_depth_mm")
ENDINGS = ("csv", "parquet")
KILLS, DAMAGES, PAIRS, CLUSTERS = 100, 50, 60, 5
# Rows of a chunk: a sweep has twelve.
CHUNK = 200
WRONG = "WRONG"

references: dict[tuple[str, str], bytes] = {}


def sweep(output: Path, quantities: str = QUANTITIES[0], *more: str) -> int:
    """Run a sweep and return its exit code; its messages go to a file beside the output."""
    args = ["sweep", str(SCENARIOS / "wilkins.toml"), *OVER, "--quantities", quantities, "--threads", "1"]
    with Path(f"{output.parent}.messages").open("a") as said, redirect_stdout(said), redirect_stderr(said):
        try:
            app([*args, *more, "-o", str(output)], prog_name="armour")
        except SystemExit as end:
            return int(end.code or 0)
        except BaseException:
            traceback.print_exc()
    return 70


def forked(run: Callable[..., int], *args: object) -> int:
    """Run a function in a process of its own and return its id."""
    child = os.fork()
    if not child:
        code = 70
        try:
            code = run(*args) % 256
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)
    return child


def exit_code(child: int) -> int:
    """Wait for a process; return its exit code, or that of a signal, below zero."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def killed(output: Path, after_s: float) -> None:
    """Begin a sweep and kill it after a time."""
    child = forked(sweep, output)
    time.sleep(after_s)
    os.kill(child, signal.SIGKILL)
    exit_code(child)


def resumed(output: Path) -> str:
    """Resume a sweep and say how that ended."""
    was_complete = output.exists()
    code = exit_code(forked(sweep, output))
    if was_complete and code == 2 and "exists already" in messages(output) and not wrong(output):
        return "complete before"
    if code or "Traceback" in messages(output) or list(output.parent.iterdir()) != [output] or wrong(output):
        return f"{WRONG}: {code} {messages(output)}"
    return "resumed, equal"


def messages(output: Path) -> str:
    """Return what the sweeps to an output said."""
    return Path(f"{output.parent}.messages").read_text()


def wrong(output: Path, quantities: str = QUANTITIES[0]) -> bool:
    """Return whether a table is not to the byte that of an undisturbed sweep."""
    return output.read_bytes() != references[output.suffix, quantities]


def outputs(folder: Path) -> Iterator[Path]:
    """Yield outputs in new folders, CSV and Parquet in turn."""
    for number in count():
        output = folder / f"{number}" / f"t.{ENDINGS[number % 2]}"
        output.parent.mkdir()
        yield output


def kills(folder: Path) -> Iterator[str]:
    """Kill sweeps at random moments, some of them several times, and resume them."""
    for number, output in zip(range(KILLS), outputs(folder), strict=False):
        times = 1 + number % 3
        for _ in range(times):
            killed(output, random.uniform(0.2, 0.9) * TIME_S)
        yield f"killed {times} times; {resumed(output)}"


def damages(folder: Path) -> Iterator[str]:
    """Damage the rows of killed sweeps and resume them."""
    for number, output in zip(range(DAMAGES), outputs(folder), strict=False):
        exit_code(forked(sweep_and_die, output))
        rows = output.parent / f"{output.name}.parts" / "rows"
        content = bytearray(rows.read_bytes())
        for _ in range(1 + number % 5):
            content[random.randrange(len(content))] ^= 1 << random.randrange(8)
        is_cut = number % 3 == 0
        rows.write_bytes(content[: random.randrange(len(content))] if is_cut else content)
        outcome = resumed(output)
        is_told = "damaged, " in messages(output)
        yield f"{'truncated' if is_cut else 'bits flipped'}, {'told' if is_told else 'not noticed'}; {outcome}"


def pairs(folder: Path) -> Iterator[str]:
    """Start pairs of sweeps of different quantities to one output."""
    refusals = ("another sweep is at work", "exists already", "contains rows", "cannot be written")
    for _, output in zip(range(PAIRS), outputs(folder), strict=False):
        children = []
        for quantities in QUANTITIES:
            children.append(forked(sweep, output, quantities))
            time.sleep(random.choice((0.0, random.uniform(0.0, TIME_S))))
        codes = [exit_code(child) for child in children]
        said = messages(output)
        if sorted(codes) != [0, 2] or "Traceback" in said or wrong(output, QUANTITIES[codes.index(0)]):
            yield f"{WRONG}: {codes} {said}"
        else:
            yield next(text for text in refusals if text in said)


def full(folder: Path) -> Iterator[str]:
    """Sweep to small file systems that fill up; make them larger and resume."""
    for number, output in zip(range(20), outputs(folder), strict=False):
        mount = ["mount", "-t", "tmpfs", "-o", f"size={16 + 10 * number}k", "armour", str(output.parent)]
        if subprocess.run(mount, capture_output=True, check=False).returncode:
            yield "not possible here"
            return
        try:
            code = exit_code(forked(sweep, output, QUANTITIES[0], "--yes"))
            subprocess.run(["mount", "-o", "remount,size=10m", str(output.parent)], check=True)
            is_told = code == 0 or (code == 2 and "cannot be written: " in messages(output))
            yield f"exit code {code}; {resumed(output)}" if is_told else f"{WRONG}: {code} {messages(output)}"
        finally:
            subprocess.run(["umount", str(output.parent)], check=True)


def workers(folder: Path) -> Iterator[str]:
    """Kill a worker of a cluster in the middle of each sweep."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster:

        def kill() -> None:
            os.kill(random.choice([worker.pid for worker in cluster.workers.values()]), signal.SIGKILL)

        for _, output in zip(range(CLUSTERS), outputs(folder), strict=False):
            with after_three_chunks(kill):
                code = sweep(output, QUANTITIES[0], "--scheduler", cluster.scheduler_address)
            is_right = code == 0 and list(output.parent.iterdir()) == [output] and not wrong(output)
            yield "a worker killed; equal" if is_right else f"{WRONG}: {code} {messages(output)}"


@contextmanager
def after_three_chunks(act: Callable[[], None]) -> Iterator[None]:
    """Act once each sweep has three chunks."""
    append = Store.append

    def append_and_act(store: Store, chunk: Chunk) -> None:
        append(store, chunk)
        if store.done == 3 * CHUNK:
            act()

    with patch.object(Store, "append", append_and_act):
        yield


def sweep_and_die(output: Path) -> int:
    """Run a sweep that is killed after three chunks."""
    with after_three_chunks(lambda: os.kill(os.getpid(), signal.SIGKILL)):
        return sweep(output)


CAMPAIGNS = {f.__name__: f for f in (kills, damages, pairs, full, workers)}
TIME_S = 60.0


def run(campaigns: Mapping[str, Callable[[Path], Iterator[str]]], place: Path) -> int:
    """Run campaigns, each in a folder of its own, and print how many of their trials had each outcome.

    Returns the exit code.
    """
    trials: Counter[str] = Counter()
    failed = 0
    for name, campaign in campaigns.items():
        folder = place / name
        folder.mkdir()
        outcomes = Counter(campaign(folder))
        print(f"{name}: {outcomes.total()} trials")
        for outcome, number in outcomes.most_common():
            print(f"  {number:4d}  {outcome}", flush=True)
        trials[name] = outcomes.total()
        failed += sum(number for outcome, number in outcomes.items() if WRONG in outcome)
    told = ", ".join(f"{number} {name}" for name, number in trials.items())
    return verdict(f"{trials.total():,} trials ({told}), {failed} ended wrong", right=not failed)


def main(names: list[str]) -> int:
    """Run campaigns; return the exit code."""
    global TIME_S
    sweeps.MAX_CHUNK = CHUNK
    for name in ("impacts", "ballistic_limits", "least_thicknesses"):
        kernel(name)
    with tempfile.TemporaryDirectory(prefix="sweeps-") as place:
        for ending in ENDINGS:
            for quantities in QUANTITIES:
                output = Path(place) / "reference" / f"{quantities}.{ending}"
                output.parent.mkdir(exist_ok=True)
                start = time.monotonic()
                assert exit_code(forked(sweep, output, quantities)) == 0
                TIME_S = min(TIME_S, time.monotonic() - start)
                references[f".{ending}", quantities] = output.read_bytes()
        return run({name: CAMPAIGNS[name] for name in names or CAMPAIGNS}, Path(place))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
