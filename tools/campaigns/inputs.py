"""Run every command on mutated inputs and report what no command may do.

A command may end with exit codes 0 to 3 only, within 60 s and 1 GiB; it prints no traceback, answers and files hold no
NaN or infinity, and a command that fails leaves no file.

    python -m tools.campaigns.inputs --trials 20000 --seed 1
"""

import argparse
import csv
import json
import os
import random
import re
import resource
import select
import signal
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import tomli_w

ROOT = Path(__file__).resolve().parents[2]
LIMIT_S, LIMIT_MIB = 60.0, 1024.0
CHECK_FAILED = 3

SCENARIOS = sorted(ROOT.glob("scenarios/**/*.toml"))
SUITES = [ROOT / "suites/paper.toml", ROOT / "tests/validation/regression.toml"]
TESTS, SHOTS = ROOT / "scenarios/tests/wilkins.csv", ROOT / "scenarios/tests/shots.csv"
CASES = "armour.ceramic_thickness_mm,impact.velocity_m_s\n6.35,800\n7.0,650\n8.5,900\n"

NUMBERS: list[Any] = [
    *(0, -1, 1, 2, 1e-3, 1e3, 1e6, 1e9, 1e-9, 1e300, -1e300, 5e-324, 1e-300, 1.7976931348623157e308),
    *(float("nan"), float("inf"), float("-inf"), 10**18, 2**63, 10**400, -0.0, 0.1, 3.0, 50.0, 400.0, 99999.5),
]
TEXTS = [
    *(
        "",
        " ",
        "x",
        "AD85",
        "B4C",
        "6061-T6",
        "7.62 mm AP",
        "perforated",
        "nan",
        "-inf",
        "=1+1",
        "@x",
        "$\\frac{1}{0}$",
    ),
    *(
        "<script>alert(1)</script>",
        "<!--<script>",
        "]]>",
        "a|b\n# c",
        "\x1b[31mred",
        "\x00",
        "\ufffe",
        "é µ ²",
        "[bold]",
    ),
    *("../../etc/passwd", "/dev/zero", "/dev/full", ".", "a" * 300, "\u202e", "\U0001f4a5", "{{ 7 * 7 }}", "%s%n"),
]
ASSIGNMENTS = [
    *("impact.velocity_m_s={}", "armour.ceramic_thickness_mm={}", "armour.backing_thickness_mm={}"),
    *("armour.ceramic={}", "armour.backing={}", "impact.projectile={}", "solver.time_step_us={}"),
    *("solver.arrest_velocity_m_s={}", "ballistic_limit.velocity_min_m_s={}", "ballistic_limit.velocity_max_m_s={}"),
    *("ballistic_limit.tolerance_m_s={}", "model.shear_perimeter={}", "optimise.ceramic_thickness_mm.step={}"),
    *("optimise.backing_thickness_mm.max={}", "library.ceramic.AD85.flow_stress_GPa={}", "armour.ceramic.x={}"),
    *("ceramic.flow_stress_GPa={}", "{}=1", "design={}", "threat={}", "uncertainty.samples={}", "title={}", "{}"),
]
LAWS = ["constant", "ceramic", "backing", "product", "linear", "all", "x"]
FITS = ["ceramic.flow_stress_GPa", "backing.flow_stress_GPa", "projectile.density_kg_m3", "x"]
QUANTITIES = ["ballistic_limit_m_s", "outcome", "residual_velocity_m_s", "required_areal_density_kg_m2", "nothing"]


class Trial(NamedTuple):
    """A command line, its input files by name and what it reads from standard input."""

    arguments: list[str]
    files: dict[str, bytes]


class Outcome(NamedTuple):
    """How a trial ended, with what was wrong."""

    code: int
    seconds: float
    mib: float
    faults: list[str]
    stderr: str


class Dice(random.Random):
    """Random numbers of a trial; a gentle one changes numbers of inputs and leaves the rest as it is."""

    gentle = False


def value(dice: Dice) -> Any:
    """Return a value that nobody meant."""
    kind = dice.random()
    if kind < 0.55:
        return dice.choice(NUMBERS)
    if kind < 0.8:
        return dice.choice(TEXTS)
    return dice.choice([True, [], {}, [1.0, 2.0], {"value": 1.0}, {"min": 1, "max": 2, "step": 0.5}, [[]], [{}]])


def places(data: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the paths of all values within TOML data."""
    found = [path] if path else []
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, inner in items:
        found += places(inner, (*path, key))
    return found


def at(data: Any, path: tuple[Any, ...]) -> Any:
    """Return the value at a path within TOML data."""
    for part in path:
        data = data[part]
    return data


def mutated_data(data: dict[str, Any], dice: Dice) -> dict[str, Any]:
    """Change one value or key of TOML data."""
    found_at = places(data)
    if not found_at:
        return {"title": value(dice)}
    numbers = [path for path in found_at if isinstance(at(data, path), float)]
    where = dice.choice(numbers if numbers and dice.random() < 0.7 else found_at)
    table: Any = data
    for part in where[:-1]:
        table = table[part]
    last, action = where[-1], dice.random()
    try:
        found = table[last]
    except KeyError:
        found = ""
    if action < 0.7 and isinstance(found, int | float) and not isinstance(found, bool):
        table[last] = float(found) * 10.0 ** (dice.choice([0.1, 0.3, 1.0, 4.0]) * dice.uniform(-1, 1))
    elif action < 0.8:
        table[last] = value(dice)
    elif action < 0.85:
        del table[last]
    elif isinstance(table, dict):
        key = dice.choice([f"{last}x", str(last)[:-1], str(last).upper(), dice.choice(TEXTS), "value"])
        table[key] = table.pop(last, 1) if action < 0.92 else value(dice)
    else:
        table.insert(dice.randrange(len(table) + 1), table[last] if action < 0.9 else value(dice))
    return data


def scaled(data: dict[str, Any], dice: Dice) -> dict[str, Any]:
    """Change one number of TOML data by a factor."""
    numbers = [path for path in places(data) if isinstance(at(data, path), float)]
    if not numbers:
        return data
    *path, last = dice.choice(numbers)
    at(data, tuple(path))[last] *= 10.0 ** (dice.choice([0.1, 0.3, 1.0]) * dice.uniform(-1, 1))
    return data


def mutated_bytes(content: bytes, dice: Dice) -> bytes:
    """Change some bytes of a file."""
    text = bytearray(content)
    for _ in range(dice.choice([1, 1, 1, 2, 5])):
        at = dice.randrange(len(text) + 1)
        end = min(at + dice.choice([1, 1, 3, 30]), len(text))
        junk = dice.choice(
            [b"", b"\x00", b"\xff", b"\xef\xbb\xbf", b"\r", b"\n", b'"', b"[", b"]]", b"=", b",", b"9" * 5000]
        )
        text[at:end] = dice.choice([junk, text[at:end] * 2, bytes(dice.randrange(256) for _ in range(end - at)), b"e9"])
    return bytes(text)


def mutated_table(content: bytes, dice: Dice) -> bytes:
    """Change one cell of a CSV table."""
    rows = list(csv.reader(content.decode().splitlines()))
    row = dice.choice(rows)
    if row:
        column = dice.randrange(len(row))
        number = row[column].replace(".", "").isdigit()
        if not dice.gentle:
            row[column] = str(value(dice))[:400]
        elif number:
            row[column] = repr(float(row[column]) * 10.0 ** dice.uniform(-0.3, 0.3))
    return "\n".join(",".join(row) for row in rows).encode(errors="replace")


def mutated(content: bytes, dice: Dice, table: bool = False) -> bytes:
    """Change a TOML file, or a table, in one to three places; one in five stays as it is or nearly so."""
    if dice.random() < 0.1:
        return content
    if not dice.gentle and dice.random() < 0.2:
        return mutated_bytes(content, dice)
    if table:
        return mutated_table(content, dice)
    data = tomllib.loads(content.decode())
    for _ in range(dice.choice([1, 1, 1, 2, 3])):
        data = scaled(data, dice) if dice.gentle else mutated_data(data, dice)
    try:
        return tomli_w.dumps(data).encode(errors="surrogatepass")
    except (TypeError, ValueError):
        return content


def scenario_files(dice: Dice, source: Path | None = None) -> tuple[str, dict[str, bytes]]:
    """Return a mutated scenario; one in six has a mutated library file as well."""
    content = (source or dice.choice(SCENARIOS)).read_bytes()
    if dice.random() < 1 / 6:
        kind, name = dice.choice([("ceramics", "ceramic"), ("metals", "metal"), ("projectiles", "projectile")])
        library = tomllib.loads((ROOT / f"configs/{kind}.toml").read_text())
        some = dice.sample(sorted(library[name]), min(3, len(library[name])))
        entries = {name: {f"{key} own": library[name][key] for key in some}}
        data = tomllib.loads(content.decode())
        data.setdefault("library", {})["files"] = ["own.toml"]
        plain = tomli_w.dumps(data).encode()
        return "s.toml", {"s.toml": mutated(plain, dice), "own.toml": mutated(tomli_w.dumps(entries).encode(), dice)}
    return "s.toml", {"s.toml": mutated(content, dice)}


def options(dice: Dice) -> list[str]:
    """Return some --set options."""
    if dice.gentle or dice.random() < 0.7:
        return []
    return [
        "--set",
        dice.choice(ASSIGNMENTS).format(dice.choice([value(dice), dice.uniform(0.01, 2000)])).replace("\0", ""),
    ]


def trial(dice: Dice) -> Trial:
    """Make a trial."""
    command = dice.choice(sorted(MAKERS))
    dice.gentle = dice.random() < 0.6
    made = MAKERS[command](dice)
    arguments = [command, *made.arguments]
    if command in ("figures", "init", "report"):
        return Trial(arguments, made.files)
    if dice.random() < 0.5:
        arguments.append("--json")
    if command in PLOTTING and dice.random() < 0.15:
        arguments += [
            "--plot",
            dice.choice(["p.svg", "p.svg", "p.png", "p.svg", *([] if dice.gentle else ["p.txt", "no/p.svg"])]),
        ]
    return Trial(arguments, made.files)


def on_scenario(*more: str) -> Callable[[Dice], Trial]:
    """Return a maker of trials of a command that reads a scenario."""

    def make(dice: Dice) -> Trial:
        name, files = scenario_files(dice)
        extra = [word for word in more if dice.random() < 0.3]
        return Trial([name, *options(dice), *extra], files)

    return make


def simulate_trial(dice: Dice) -> Trial:
    """Make arguments of `simulate`."""
    name, files = scenario_files(dice)
    velocity = ["--velocity", str(dice.choice([800.0] if dice.gentle else NUMBERS))] if dice.random() < 0.3 else []
    history = ["--history", "h.csv"] if dice.random() < 0.3 else []
    return Trial([name, *options(dice), *velocity, *history], files)


def optimise_trial(dice: Dice) -> Trial:
    """Make arguments of `optimise`."""
    with_grid = [path for path in SCENARIOS if b"[optimise]" in path.read_bytes() or b"[design]" in path.read_bytes()]
    name, files = scenario_files(dice, dice.choice(with_grid))
    return Trial([name, *options(dice), *(["--refine"] if dice.random() < 0.2 else []), "--csv", "f.csv"], files)


def uncertainty_trial(dice: Dice) -> Trial:
    """Make arguments of `uncertainty`."""
    name, files = scenario_files(
        dice, dice.choice([ROOT / "scenarios/uncertain.toml", ROOT / "scenarios/reliable.toml"])
    )
    return Trial(
        [
            name,
            *options(dice),
            "--samples",
            str(dice.choice([128, 256, 1024, *([] if dice.gentle else [100, 0, -5, 10**7, 10**30])])),
        ],
        files,
    )


def sweep_trial(dice: Dice) -> Trial:
    """Make arguments of `sweep`."""
    name, files = scenario_files(dice)
    arguments = [
        name,
        *options(dice),
        "-o",
        dice.choice(["t.csv", "t.csv", "t.parquet", "t.csv" if dice.gentle else "t.txt"]),
    ]
    arguments += [
        "--quantities",
        ",".join(dice.sample(QUANTITIES[: dice.choice([3, 3, 4]) if dice.gentle else 5], dice.choice([1, 2]))),
    ]
    if dice.random() < 0.5:
        return Trial([*arguments, "--cases", "c.csv"], {**files, "c.csv": mutated(CASES.encode(), dice, table=True)})
    for _ in range(dice.choice([1, 2])):
        key = dice.choice(ASSIGNMENTS[: 3 if dice.gentle else None]).partition("=")[0].replace("{}", "x")
        values = (
            "4:8:1"
            if dice.gentle
            else dice.choice(
                ["4:8:1", "600,700,800", str(value(dice)), f"1:{dice.choice(NUMBERS)}:{dice.choice(NUMBERS)}"]
            )
        )
        arguments += ["--over", f"{key}={values}".replace("\0", "")]
    return Trial(arguments, files)


def calibrate_trial(dice: Dice) -> Trial:
    """Make arguments of `calibrate`."""
    name, files = scenario_files(dice, ROOT / "scenarios/wilkins.toml")
    fits = dice.sample(FITS[: 3 if dice.gentle else 4], dice.choice([0, 1, 2]))
    chosen = [word for fit in fits for word in ("--fit", fit)]
    law = ["--law", dice.choice(LAWS[: 6 if dice.gentle else 7])] if dice.random() < 0.3 else []
    tests = mutated(TESTS.read_bytes(), dice, table=True)
    writes = ["--write", "w.toml", "--write-scenario", "fitted.toml"]
    return Trial(["t.csv", name, *chosen, *law, *writes], {**files, "t.csv": tests})


def v50_trial(dice: Dice) -> Trial:
    """Make arguments of `v50`."""
    files = {"shots.csv": mutated(SHOTS.read_bytes(), dice, table=True)}
    arguments = ["shots.csv"]
    if dice.random() < 0.4:
        name, more = scenario_files(dice)
        files, arguments = {**files, **more}, [*arguments, name, *options(dice)]
    for option in ("--pairs", "--span-m-s", "--confidence"):
        if not dice.gentle and dice.random() < 0.15:
            arguments += [option, str(dice.choice(NUMBERS[:-8]))]
    return Trial(arguments, files)


def validate_trial(dice: Dice) -> Trial:
    """Make arguments of `validate`."""
    path = dice.choice(SUITES)
    suite = tomllib.loads(path.read_text())
    for kind in ("case", "table"):
        if kind in suite:
            suite[kind] = dice.sample(suite[kind], min(2, len(suite[kind])))
    for section in (*suite.get("case", []), *suite.get("table", [])):
        section["scenario"] = str((path.parent / section["scenario"]).resolve())
    files = {"suite.toml": mutated(tomli_w.dumps(suite).encode(), dice)}
    outputs = [word for pair in (["--markdown", "v.md"], ["--junit", "v.xml"]) if dice.random() < 0.4 for word in pair]
    return Trial(["suite.toml", *options(dice), *outputs, *(["--update"] if dice.random() < 0.1 else [])], files)


def report_trial(dice: Dice) -> Trial:
    """Make arguments of `report`."""
    name, files = scenario_files(dice)
    return Trial(
        [name, *options(dice), "-o", dice.choice(["r.html", "r.md", *([] if dice.gentle else ["r.txt", "s.toml"])])],
        files,
    )


def library_trial(dice: Dice) -> Trial:
    """Make arguments of `library`."""
    text = dice.choice(TEXTS).replace("\0", "")
    return Trial(["show", text] if dice.random() < 0.7 else [], {})


def init_trial(dice: Dice) -> Trial:
    """Make arguments of `init`."""
    return Trial(
        [dice.choice(["n.toml", "no/n.toml", ".", "a" * 252]), "--from", dice.choice(["wilkins", "x", "../x"])], {}
    )


MAKERS: dict[str, Callable[[Dice], Trial]] = {
    "simulate": simulate_trial,
    "ballistic-limit": on_scenario(),
    "optimise": optimise_trial,
    "sweep": sweep_trial,
    "calibrate": calibrate_trial,
    "uncertainty": uncertainty_trial,
    "sensitivity": on_scenario(),
    "v50": v50_trial,
    "report": report_trial,
    "compare": on_scenario(),
    "validate": validate_trial,
    "library": library_trial,
    "init": init_trial,
}
PLOTTING = (
    "simulate",
    "ballistic-limit",
    "optimise",
    "sweep",
    "calibrate",
    "uncertainty",
    "sensitivity",
    "v50",
    "compare",
)


def run(made: Trial, folder: Path) -> Outcome:
    """Run a trial in a child of this process, which has imported the program."""
    for name, content in made.files.items():
        (folder / name).write_bytes(content)
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    start = time.monotonic()
    child = os.fork()
    if not child:
        in_child(made, folder)
    pidfd = os.pidfd_open(child)
    ended, _, _ = select.select([pidfd], [], [], LIMIT_S)
    os.close(pidfd)
    if not ended:
        os.kill(child, signal.SIGKILL)
    _, status, usage = os.wait4(child, 0)
    seconds = time.monotonic() - start
    code = os.waitstatus_to_exitcode(status)
    stdout, stderr = ((folder.parent / name).read_text(errors="replace") for name in ("out", "err"))
    faults = [] if ended else [f"longer than {LIMIT_S:g} s"]
    if code not in (0, 1, 2, CHECK_FAILED):
        faults.append(f"exit code {code}")
    if "Traceback" in stderr:
        faults.append("traceback")
    if usage.ru_maxrss > LIMIT_MIB * 1024:
        faults.append(f"{usage.ru_maxrss / 1024:.0f} MiB")
    after = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    written = [path for path in after if after[path] != before.get(path)]
    if code and code != CHECK_FAILED and (written or set(before) - set(after)):
        faults.append(f"files of a failed command: {[path.name for path in written]}")
    if not code and "--json" in made.arguments:
        faults += not_strict_json(stdout)
    elif not code:
        faults += ["nan or inf in the answer"] if re.search(r"(?<![\w\"'=.-])[-+]?(nan|inf)(?![\w\"'])", stdout) else []
    for path in written:
        faults += malformed(path)
    return Outcome(code, seconds, usage.ru_maxrss / 1024, faults, stderr)


def in_child(made: Trial, folder: Path) -> None:
    """Run the command line in this process, which ends."""
    from armour.cli.app import app

    os.chdir(folder)
    os.setpgrp()
    for descriptor, name in ((1, "out"), (2, "err")):
        file = os.open(folder.parent / name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, descriptor)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    code = 99
    try:
        app(made.arguments, prog_name="armour")
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0 if end.code is None else 98
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def warm_up() -> None:
    """Import all that the commands need, so that each trial starts with it."""
    from typer.testing import CliRunner

    from armour.cli.app import app

    with tempfile.TemporaryDirectory() as folder:
        wilkins, shots_file = str(ROOT / "scenarios/wilkins.toml"), str(SHOTS)
        for words in (
            ["simulate", wilkins, "--plot", f"{folder}/p.svg"],
            ["ballistic-limit", wilkins],
            ["optimise", wilkins],
            ["sensitivity", wilkins],
            ["compare", wilkins],
            ["v50", shots_file, wilkins],
            ["calibrate", str(TESTS), wilkins],
            ["uncertainty", str(ROOT / "scenarios/uncertain.toml"), "--samples", "128"],
            ["report", wilkins, "-o", f"{folder}/r.html"],
            ["validate", "--only", "fig"],
        ):
            CliRunner().invoke(app, words)
    import pyarrow.csv
    import pyarrow.parquet  # noqa: F401


def not_strict_json(text: str) -> list[str]:
    """Return what is wrong with JSON that must hold neither NaN nor infinity."""

    def refuse(constant: str) -> None:
        raise ValueError(constant)

    try:
        json.loads(text, parse_constant=refuse)
    except ValueError as error:
        return [f"JSON: {error}"[:80]]
    return []


def malformed(path: Path) -> list[str]:
    """Return what is wrong with an output."""
    if path.suffix in (".svg", ".xml"):
        try:
            ElementTree.parse(path)
        except ElementTree.ParseError as error:
            return [f"{path.name}: {error}"]
    if path.suffix == ".csv":
        with path.open(newline="") as file:
            cells = {cell.strip().lower() for row in csv.reader(file) for cell in row}
        if cells & {"nan", "inf", "-inf", "infinity", "-infinity"}:
            return [f"{path.name}: nan or inf"]
    return []


def main() -> int:
    """Run the trials and print what was wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="run the trial of this number alone and show it")
    arguments = parser.parse_args()
    warm_up()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    codes: Counter[tuple[str, int]] = Counter()
    faulty, slowest, largest = 0, 0.0, 0.0
    numbers = range(arguments.trials) if arguments.only is None else [arguments.only]
    for number in numbers:
        made = trial(Dice(f"{arguments.seed} {number}"))
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / "work"
            folder.mkdir()
            outcome = run(made, folder)
        codes[made.arguments[0], outcome.code] += 1
        slowest, largest = max(slowest, outcome.seconds), max(largest, outcome.mib)
        if outcome.faults or arguments.only is not None:
            faulty += bool(outcome.faults)
            last = outcome.stderr.strip().splitlines()[-1:] if arguments.only is None else [outcome.stderr]
            print(number, made.arguments, outcome.code, f"{outcome.seconds:.1f} s", outcome.faults, *last, flush=True)
        if arguments.only is not None:
            for file, content in made.files.items():
                print(f"--- {file}\n{content.decode(errors='replace')}")
    for (command, code), count in sorted(codes.items()):
        print(f"{command:16} exit code {code:4} {count:6}")
    print(f"{len(numbers)} trials, {faulty} faulty; slowest {slowest:.1f} s, largest {largest:.0f} MiB")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
