"""Kill sweeps, damage their chunks, start two to one output, and fill disks: each ends right or with a message.

    python -m tools.campaigns.sweeps [NAME]...

runs the named campaigns, by default all; it counts how the trials ended, and exits with 3 if one ended wrong.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout
from itertools import count
from pathlib import Path

from armour.cli.app import app
from armour.engine.cache import kernel
from armour.sweeps import sweep as sweeps
from tests.helpers.cases import SCENARIOS
from tests.helpers.faults import Fault, faults, full_disk
from tools.campaigns.verdict import verdict

OVER = ["--over", "armour.ceramic_thickness_mm=2:12:0.05", "--over", "impact.velocity_m_s=700:900:20"]
QUANTITIES = ("residual_velocity_m_s,outcome", "penetration_depth_mm")
ENDINGS = ("csv", "parquet")
KILLS = 100
DAMAGES = 50
PAIRS = 60
# Most that a kill may cost on a busy machine.
LOST_S = 3.0
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


def faulty_sweep(output: Path, step: int, fault: Fault) -> int:
    """Run a sweep with a fault at a step on files; return -1 if it has not so many steps."""
    with faults(step, fault) as steps:
        code = sweep(output)
    return code if len(steps) > step else -1


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


def resumed(output: Path) -> str:
    """Resume a sweep and say how that ended."""
    done = output.exists()
    code = exit_code(forked(sweep, output))
    if done:  # a kill between the last two steps leaves the folder
        shutil.rmtree(output.with_name(f"{output.name}.parts"), ignore_errors=True)
    if "Traceback" in messages(output) or list(output.parent.iterdir()) != [output] or wrong(output):
        return f"{WRONG}: {code} {messages(output)}"
    if code == 2 and done:
        return "complete before"
    return "resumed, equal" if code == 0 else f"{WRONG}: {code} {messages(output)}"


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
    """Kill sweeps at random moments until they end, and resume them."""
    new = outputs(folder)
    output = next(new)
    for _ in range(KILLS):
        child = forked(sweep, output)
        time.sleep(random.uniform(0.2, 0.9) * TIME_S)
        os.kill(child, signal.SIGKILL)
        exit_code(child)
        if random.random() < 0.5:
            state = "no folder" if not output.parent.joinpath(output.name + ".parts").exists() else "in work"
            yield f"killed with {state}; {resumed(output)}"
            output = next(new)
        elif output.exists():
            yield f"killed once complete; {resumed(output)}"
            output = next(new)
        else:
            yield "killed again before it was resumed"
    yield f"at the end: {resumed(output)}"


def losses(folder: Path) -> Iterator[str]:
    """Kill or interrupt sweeps of fast and slow rows, and tell how much of their work is lost."""
    for quantity in (
        "areal_density_kg_m2",
        "residual_velocity_m_s",
        "ballistic_limit_m_s",
        "required_total_thickness_mm",
    ):
        over = ["--over", "armour.backing_thickness_mm=2:12:0.001", "--over", "projectile.flow_stress_GPa=1:3:0.01"]
        output = folder / quantity / "t.csv"
        output.parent.mkdir()
        command = [
            sys.executable,
            "-m",
            "armour",
            "sweep",
            "paper/optimum_7.62mm_AP",
            *over,
            "-o",
            str(output),
            "--yes",
        ]
        for kind in (signal.SIGKILL, signal.SIGINT):
            before = len(list(output.parent.glob("t.csv.parts/*.npz")))
            child = subprocess.Popen([*command, "--quantities", quantity], stderr=subprocess.DEVNULL)
            # On a busy machine the program takes long to start.
            while child.poll() is None and len(list(output.parent.glob("t.csv.parts/*.npz"))) <= before:
                time.sleep(0.1)
            time.sleep(random.uniform(2.0, 5.0))
            now = time.time()
            child.send_signal(kind)
            child.wait()
            chunks = [path.stat().st_mtime for path in output.parent.glob("t.csv.parts/*.npz")]
            if output.exists():
                output.unlink()
                yield f"{quantity}: complete before"
                continue
            lost = now - max(chunks, default=0.0)
            yield f"{quantity}: {kind.name}, {lost:.1f} s lost" if lost < LOST_S else f"{WRONG}: {lost:.1f} s lost"


def steps(folder: Path) -> Iterator[str]:
    """Kill sweeps before, or in the middle of, each of their steps on files, and resume them."""

    def kill(_step: str) -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    yield from at_each_step(folder, kill, expected=-signal.SIGKILL)


def full(folder: Path) -> Iterator[str]:
    """Let the disk be full from each step on files on; make space and resume."""
    yield from at_each_step(folder, full_disk, expected=2)


def at_each_step(folder: Path, fault: Fault, expected: int) -> Iterator[str]:
    """Disturb a sweep at each of its steps on files, and resume it."""
    for ending in ENDINGS:
        for step in count():
            output = folder / f"{ending}{step}" / f"t.{ending}"
            output.parent.mkdir()
            code = exit_code(forked(faulty_sweep, output, step, fault))
            if code == 255:
                break
            if output.exists() and wrong(output):
                yield f"{WRONG}: table at step {step}"
            if code != expected and not (code == 0 and output.exists()):
                yield f"{WRONG}: {code} at step {step} {messages(output)}"
            yield f"exit code {code}; {resumed(output)}"


def damages(folder: Path) -> Iterator[str]:
    """Damage chunks of killed sweeps and resume them."""
    new = outputs(folder)
    for number in range(DAMAGES):
        output = next(new)
        parts = output.with_name(output.name + ".parts")
        child = forked(sweep, output)
        while len(list(parts.glob("*.npz"))) < 3:
            pass
        os.kill(child, signal.SIGKILL)
        exit_code(child)
        chunks = sorted(parts.glob("*.npz"))
        kind = number // 2 % 5
        chosen = random.choice(chunks)
        if kind == 0:
            data = bytearray(chosen.read_bytes())
            data[random.randrange(len(data))] ^= 1 << random.randrange(8)
            chosen.write_bytes(data)
        elif kind == 1:
            os.truncate(chosen, random.randrange(chosen.stat().st_size))
        elif kind == 2:
            chosen.write_bytes(b"")
        elif kind == 3:
            one, other = random.sample(chunks, 2)
            content = one.read_bytes()
            shutil.copy(other, one)
            other.write_bytes(content)
        else:
            chosen.unlink()
        name = ("a bit flipped", "truncated", "emptied", "exchanged", "deleted")[kind]
        outcome = resumed(output)
        # A bit of what zip does not read, such as a date, does no harm.
        if kind not in (0, 4) and "damaged, computed again" not in messages(output):
            outcome = f"{WRONG}: not noticed"
        yield f"{name}: {outcome}"


def pairs(folder: Path) -> Iterator[str]:
    """Start pairs of sweeps of different quantities to one output."""
    new = outputs(folder)
    for _ in range(PAIRS):
        output = next(new)
        children = []
        for quantities in QUANTITIES:
            children.append(forked(sweep, output, quantities))
            time.sleep(random.choice((0.0, random.uniform(0.0, TIME_S))))
        codes = [exit_code(child) for child in children]
        done = [quantities for quantities, code in zip(QUANTITIES, codes, strict=True) if code == 0]
        if sorted(codes) != [0, 2] or "Traceback" in messages(output) or wrong(output, done[0]):
            yield f"{WRONG}: {codes} {messages(output)}"
        else:
            said = messages(output)
            yield next(
                text for text in ("another sweep is at work", "exists already", "contains chunks") if text in said
            )


def tmpfs(folder: Path) -> Iterator[str]:
    """Sweep to small file systems that fill up; make them larger and resume."""
    sizes = {".csv": range(32, 172, 14), ".parquet": range(32, 172, 14)}
    for ending in ENDINGS:
        for size in sizes[f".{ending}"]:
            output = folder / f"{ending}{size}" / f"t.{ending}"
            output.parent.mkdir()
            mount = ["mount", "-t", "tmpfs", "-o", f"size={size}k", "armour", str(output.parent)]
            if subprocess.run(mount, capture_output=True, check=False).returncode:
                yield "not possible here"
                return
            try:
                code = exit_code(forked(sweep, output, QUANTITIES[0], "--yes"))
                subprocess.run(["mount", "-o", "remount,size=10m", str(output.parent)], check=True)
                told = code == 0 or (code == 2 and "no space left" in messages(output))
                yield f"exit code {code}; {resumed(output)}" if told else f"{WRONG}: {code} {messages(output)}"
            finally:
                subprocess.run(["umount", str(output.parent)], check=True)


CAMPAIGNS = {f.__name__: f for f in (kills, losses, steps, damages, pairs, full, tmpfs)}
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
