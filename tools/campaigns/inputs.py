"""Run every command, with every option, on mutated inputs and report what no command may do.

A command may end with exit codes 0 to 3 only, within 60 s of computing on all cores and 1 GiB; it prints no traceback,
answers and files contain no NaN or infinity, and a command that fails leaves no file.

    python -m tools.campaigns inputs

The commands and their options are those of the program.
"""

import codecs
import csv
import json
import os
import random
import re
import signal
import sys
import tempfile
import tomllib
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import chdir
from functools import partial, reduce
from multiprocessing import get_context
from operator import getitem
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import tomli_w
import typer

from armour.engine.batch import available_cores
from armour.reporting.junit import BEGINNING
from tests.helpers.spreadsheets import export
from tools.budget import commands
from tools.campaigns.trials import ERROR, forked
from tools.campaigns.verdict import asked, verdict

ROOT = Path(__file__).resolve().parents[2]
# Time of computing on all cores, and any.
LIMIT_S, HANGING_S = 60.0, 600
LIMIT_MIB = 1024.0
DONE, NO_ANSWER, WRONG_INPUT, CHECK_FAILED = 0, 1, 2, 3
# In a cell or after a key, and in the data of a map or of JSON; in a table of CSV.
_DATA = r"[>|=] *-?(nan|inf)\b|(?:[\[,]|\x22:) ?-?(NaN|Infinity)[,\]}]"
NOT_A_NUMBER = dict.fromkeys((".html", ".md", ".toml", ".json", ".ipynb"), _DATA)
NOT_A_NUMBER |= {".csv": r"(?im)(?:^|,) *-?(nan|inf|infinity) *(?:,|$)"}
# Parts of the trials that are gentle, and that read the scenario from standard input.
GENTLE, PIPED = 0.6, 0.05

SCENARIOS = sorted({*ROOT.glob("scenarios/**/*.toml")} - {*ROOT.glob("scenarios/templates/*")})
NAMED = {path.relative_to(ROOT / "scenarios").with_suffix("").as_posix(): path for path in SCENARIOS}
SUITES = [ROOT / "suites/paper.toml", ROOT / "suites/plates.toml", ROOT / "tests/validation/regression.toml"]
TESTS = {name: ROOT / f"scenarios/tests/{name}.csv" for name in ("wilkins", "unknown_ceramic")}
SHOTS = ROOT / "scenarios/tests/shots.csv"
CASES = "armour.ceramic_thickness_mm,impact.velocity_m_s\n6.35,800\n7.0,650\n8.5,900\n"
# Every key there is.
TEMPLATE = re.sub(r"^# (?=[\[a-z])", "", (ROOT / "scenarios/template.toml").read_text(), flags=re.MULTILINE)

SCRIPT = "<script>alert(1)</script>"
NUMBERS: list[Any] = [
    *(0, -1, 1, 2, 1e-3, 1e3, 1e6, 1e9, 1e-9, 1e300, -1e300, 5e-324, 1e-300, 1.7976931348623157e308),
    *(float("nan"), float("inf"), float("-inf"), 10**18, 2**63, 10**400, -0.0, 0.1, 3.0, 50.0, 400.0, 99999.5),
]
TEXTS = [
    *("", " ", "x", "AD85", "B4C", "6061-T6", "7.62 mm AP", "perforated", "nan", "-inf", "=1+1", "@x"),
    "$\\frac{1}{0}$",
    *(SCRIPT, "<!--<script>", "]]>", "a|b\n# c", "\x1b[31mred", "\x00", "\ufffe", "é µ ²", "[bold]"),
    *("../../etc/passwd", "/dev/zero", "/dev/full", ".", "a" * 300, "\u202e", "\U0001f4a5", "{{ 7 * 7 }}", "%s%n"),
]
QUANTITIES = ("ballistic_limit_m_s", "outcome", "residual_velocity_m_s", "probability_of_stopping", "mass_lost_percent",
              "required_areal_density_kg_m2")  # fmt: skip
ASSIGNMENTS = [
    *("impact.velocity_m_s={}", "armour.ceramic_thickness_mm={}", "armour.backing_thickness_mm={}"),
    *("armour.ceramic={}", "armour.backing={}", "impact.projectile={}", "solver.time_step_us={}"),
    *("solver.arrest_velocity_m_s={}", "ballistic_limit.velocity_min_m_s={}", "ballistic_limit.velocity_max_m_s={}"),
    *("ballistic_limit.tolerance_m_s={}", "model.shear_perimeter={}", "optimise.ceramic_thickness_mm.step={}"),
    *("optimise.backing_thickness_mm.max={}", "library.ceramic.AD85.flow_stress_GPa={}", "armour.ceramic.x={}"),
    *("model.plate_drive={}", "design.existing={}", "armour.layer={}", "design.areal_density_max_kg_m2={}"),
    *("ceramic.flow_stress_GPa={}", "{}=1", "design={}", "threat={}", "uncertainty.samples={}", "title={}", "{}"),
]


# What a signal that ends a trial says.
SIGNALS = {-signal.SIGPROF: f"longer than {LIMIT_S:g} s", -signal.SIGALRM: f"longer than {HANGING_S} s"}


class Trial(NamedTuple):
    """A command line, its input files by name, and what it reads from standard input."""

    command: str
    arguments: list[str]
    files: dict[str, bytes]
    stdin: bytes


class Outcome(NamedTuple):
    """How a trial ended, with what was wrong."""

    code: int
    seconds: float  # of computing
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


def mutated_data(data: dict[str, Any], dice: Dice) -> dict[str, Any]:
    """Change one value or key of TOML data, or one number of gentle data by a factor."""
    paths = places(data)
    numbers = [path for path in paths if isinstance(reduce(getitem, path, data), float)]
    if not (numbers if dice.gentle else paths):
        return data if dice.gentle else {"title": value(dice)}
    *path, last = dice.choice(numbers if dice.gentle or (numbers and dice.random() < 0.7) else paths)
    table, action = reduce(getitem, path, data), dice.random()
    if dice.gentle or (action < 0.7 and isinstance(table[last], float)):
        table[last] *= 10.0 ** (dice.choice([0.1, 0.3, 1.0, 1.0 if dice.gentle else 4.0]) * dice.uniform(-1, 1))
    elif action < 0.8:
        table[last] = value(dice)
    elif action < 0.85:
        del table[last]
    elif isinstance(table, dict):
        key = dice.choice([f"{last}x", str(last)[:-1], str(last).upper(), dice.choice(TEXTS), "value"])
        table[key] = table.pop(last, 1) if action < 0.92 else value(dice)
    else:
        table.insert(dice.randrange(len(table) + 1), table[last])
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
        data = mutated_data(data, dice)
    return tomli_w.dumps(data).encode(errors="surrogatepass")


class Maker:
    """Makes the words of a command line, and its files."""

    def __init__(self, command: str, dice: Dice) -> None:
        self.command, self.dice = command, dice
        self.files: dict[str, bytes] = {}
        self.suited = dice.choice(SUITED.get(command, [*NAMED]))

    def scenario(self, name: str = "s.toml") -> str:
        """Return the name of a scenario: a mutated one; one in six has a mutated library file as well."""
        dice, chance = self.dice, self.dice.random()
        if chance < 0.05:
            return self.suited
        content = NAMED[self.suited if chance < 0.8 else dice.choice([*NAMED])].read_bytes()
        if chance > 0.95:
            content = TEMPLATE.encode()
        if dice.random() < 1 / 6:
            kind, section = dice.choice([("ceramics", "ceramic"), ("metals", "metal"), ("projectiles", "projectile")])
            library = tomllib.loads((ROOT / f"configs/{kind}.toml").read_text())
            some = dice.sample(sorted(library[section]), min(3, len(library[section])))
            entries = {section: {f"{key} own": library[section][key] for key in some}}
            self.files["own.toml"] = mutated(tomli_w.dumps(entries).encode(), dice)
            data = tomllib.loads(content.decode())
            data.setdefault("library", {})["files"] = ["own.toml"]
            content = tomli_w.dumps(data).encode()
        return self.file(name, mutated(content, dice))

    def suite(self) -> str:
        """Return the name of a mutated suite of a few cases."""
        path = self.dice.choice(SUITES)
        suite = tomllib.loads(path.read_text())
        for kind in ("case", "table"):
            if kind in suite:
                suite[kind] = self.dice.sample(suite[kind], min(2, len(suite[kind])))
                for section in suite[kind]:
                    for key in ("scenario", "cases"):
                        if isinstance(section.get(key), str):
                            section[key] = str((path.parent / section[key]).resolve())
        return self.file("suite.toml", mutated(tomli_w.dumps(suite).encode(), self.dice))

    def table(self, name: str, content: bytes) -> str:
        """Return the name of a mutated table."""
        return self.file(name, mutated(content, self.dice, table=True))

    def shots(self) -> str:
        """Return the name of a table of shots: the shipped one, or an export of a spreadsheet."""
        if self.dice.random() < 0.5:
            return self.table("shots.csv", SHOTS.read_bytes())
        content = bytearray(export(self.dice).content)
        if not self.dice.gentle:
            content[self.dice.randrange(len(content))] = self.dice.randrange(256)
        return self.file("shots.csv", bytes(content))

    def tests(self) -> str:
        """Return the name of tests, mostly those of the scenario."""
        return self.table("t.csv", TESTS.get(self.suited, TESTS["wilkins"]).read_bytes())

    def file(self, name: str, content: bytes) -> str:
        """Return the name of a file."""
        self.files[name] = content
        is_given = self.dice.gentle or self.dice.random() < 0.97
        return name if is_given else self.dice.choice(["missing", ".", "/dev/null"])

    def assignment(self) -> str:
        """Return a change of a scenario."""
        found = self.dice.choice([value(self.dice), self.dice.uniform(0.01, 2000)])
        return self.dice.choice(ASSIGNMENTS).format(found) if not self.dice.gentle else self.dice.choice(
            ["impact.velocity_m_s=700", "impact.obliquity_deg=30", "armour.ceramic_thickness_mm=9"]
        )  # fmt: skip

    def values(self) -> str:
        """Return a key with values."""
        dice = self.dice
        key = dice.choice(ASSIGNMENTS[: 3 if dice.gentle else None]).partition("=")[0].replace("{}", "x")
        wild = [str(value(dice)), f"1:{dice.choice(NUMBERS)}:{dice.choice(NUMBERS)}"]
        return f"{key}={dice.choice(['4:8:1', '600,700,800', '5', *([] if dice.gentle else wild)])}"

    def written(self, *names: str) -> str:
        """Return the name of a file to write."""
        wild = ["s.toml", "shots.csv", "p.txt", "no/p.svg", ".", "a" * 300, "/dev/full", "p.dat", ""]
        return self.dice.choice(names if self.dice.gentle or self.dice.random() < 0.8 else wild)

    def among(self, *some: object) -> str:
        """Return one of some words or numbers; of three numbers, the first two may be ends."""
        if not self.dice.gentle and self.dice.random() < 0.3:
            return str(value(self.dice))
        return str(self.dice.choice(some))

    def between(self, low: float, high: float) -> str:
        """Return a number."""
        return self.among(round(self.dice.uniform(low, high), self.dice.choice([0, 2, 15])))

    def value(self, name: str, kind: str) -> str:
        """Return a value of an option or argument, given what the help calls the value."""
        if make := VALUES.get(name) or VALUES.get(kind):
            return make(self)
        if name not in WORDS and kind == "NUMBER":
            return self.between(*next(ends for part, ends in RANGES.items() if re.search(part, name)))
        if name in FILES or kind == "FILE":
            return self.written(*FILES.get(name, (f"{name.strip('-')}.csv",)))
        return self.among(*WORDS.get(name, TEXTS))

    def words(self) -> Iterator[str]:
        """Yield the words of the command line."""
        yield from self.command.split()
        for param in COMMANDS[self.command]:
            name, often = param.opts[-1 if param.opts[-1].startswith("--") else 0], 1.0 if param.required else 0.2
            if not param.required and self.dice.random() > OFTEN.get(name, often):
                continue
            if param.is_flag if isinstance(param, typer.core.TyperOption) else False:
                yield name
                continue
            for _ in range(self.dice.choice([1, 1, 2]) if param.multiple else 1):
                found = self.value(name, param.metavar or "").replace("\0", "").encode(errors="replace").decode()
                yield from [name, found] if name.startswith("-") else [found]


# Values of the parameters, by the name of an option or by what the help calls it.
VALUES: dict[str, Callable[[Maker], str]] = {
    "SCENARIO": Maker.scenario,
    "SCENARIO|SUITE": lambda maker: maker.scenario() if maker.dice.random() < 0.7 else maker.suite(),
    "SUITE": Maker.suite,
    "SHOTS": Maker.shots,
    "TESTS": Maker.tests,
    "KEY=VALUE": Maker.assignment,
    "KEY=VALUES": Maker.values,
    "--cases": lambda maker: maker.table("c.csv", CASES.encode()),
    "--against": lambda maker: maker.table("c.json", EARLIER[0]),
    "--quantities": lambda maker: ",".join(sorted({maker.among(*QUANTITIES) for _ in range(2)})),
}
WORDS: dict[str, tuple[object, ...]] = {
    "words": (*TEXTS, "STANAG 4569 level 3, B32", "HHA Class 1", "metals", "7.62"),
    "--keep": ("offer", *TEXTS),
    **dict.fromkeys(("--each", "--ignore"), ("panel", "Tile lot", "Angle", "void", *TEXTS)),
    "--where": ("panel=A", "panel=1", "remark=x", "x", *TEXTS),
    "--sheet": ("Sheet1", *TEXTS),
    "--from": ("wilkins", "paper", "tests/shots", "study.ipynb", "template", "threats/nij_iv", "x", "../x"),
    "--samples": (128, 256, 1024, "512"),
    "--only": ("fig09", "fig10", "x", "7.62"),
    "--fit": ("ceramic.flow_stress_GPa", "backing.flow_stress_GPa", "projectile.density_kg_m3"),
    "--law": ("constant", "ceramic", "backing", "product", "linear"),
    "--procedure": ("bayesian", "neyer", "langlie", "up-and-down"),
    "--result": ("partial", "complete", "p", "cp"),
}
# Ends of numbers, by a part of the name of the option.
RANGES = {"fraction|probability|confidence": (0.01, 0.999), "factor": (1.1, 4.0), "percent": (0.5, 8.0)}
RANGES |= {"scatter|span|width": (5.0, 60.0), "": (300.0, 1500.0)}
# Names of files to write, by the name of the option; of others, that with the ending of a table.
FILES = {
    "--plot": ("p.svg", "p.svg", "p.png", "p.pdf"),
    "--output": ("o.csv", "o.csv", "o.parquet", "r.html", "r.md"),
    "--junit": ("j.xml",),
    "--map": ("m.html",),
    "--markdown": ("v.md",),
    "--report": ("r.html",),
    "--save": ("b.toml",),
    "--write": ("w.toml",),
    "--write-scenario": ("fitted.toml",),
    "file": ("n.toml", "n.csv", "n.ipynb", "no/n.toml"),
    "folder": ("new", "."),
}
# How often an option is given that is not given in a fifth of the trials.
OFTEN = {
    **{"--json": 0.5, "--set": 0.15, "--plot": 0.1, "--force": 0.1, "--list": 0.05, "--update": 0.1},
    **{"--only": 0.7, "--scheduler": 0.02, "--sheet": 0.02, "--keep": 0.05, "--by-model": 0.05, "--over": 0.6},
    **{"suite": 0.95, "table": 0.7, "--yes": 0.0},
}
# Scenarios of which a command mostly reads one.
SUITED = {
    "optimise": [name for name, path in NAMED.items() if re.search(rb"\[optimise\]|\[design\]", path.read_bytes())],
    "check": ["wilkins", "oblique", "catalogue", "reliable", "threats/nij_iv", "paper/optimum_7.62mm_AP"],
    "uncertainty": ["uncertain", "reliable"],
    "calibrate": ["wilkins", "unknown_ceramic"],
    "plan shots": ["wilkins", "bare_plate", "paper/optimum_7.62mm_AP", "unknown_ceramic"],
}
COMMANDS: dict[str, list[Any]] = {}
# What an earlier check printed.
EARLIER: list[bytes] = []
# Trials of a command of which some must end with exit code 0.
FEW = 100
# Numbers of trials relative to other commands: of some that take long on any input, or whose input is simple.
WEIGHTS = {"calibrate": 0.5, "report": 0.5, "sensitivity": 0.5, "uncertainty": 0.5, "figures": 0.1, "schema": 0.1}


def trial(dice: Dice) -> Trial:
    """Make a trial."""
    [command] = dice.choices([*COMMANDS], [WEIGHTS.get(name, 1.0) for name in COMMANDS])
    dice.gentle = dice.random() < GENTLE
    maker = Maker(command, dice)
    words = [*maker.words()]
    stdin = b""
    if "s.toml" in words and "s.toml" in maker.files and dice.random() < PIPED:
        words[words.index("s.toml")], stdin = "-", maker.files["s.toml"]
    return Trial(command, words, maker.files, stdin)


def run(made: Trial, folder: Path) -> Outcome:
    """Run a trial in a child of this process, which has imported the program."""
    for name, content in made.files.items():
        (folder / name).write_bytes(content)
    (folder.parent / "in").write_bytes(made.stdin)
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    _, status, usage = os.wait4(forked(in_child, made, folder), 0)
    seconds, code = usage.ru_utime + usage.ru_stime, os.waitstatus_to_exitcode(status)
    stdout, stderr = ((folder.parent / name).read_text(errors="replace") for name in ("out", "err"))
    faults = [] if code in range(CHECK_FAILED + 1) else [SIGNALS.get(code, f"exit code {code}")]
    faults += ["traceback"] if "Traceback" in stderr else []
    faults += [f"{usage.ru_maxrss / 1024:.0f} MiB"] if usage.ru_maxrss > LIMIT_MIB * 1024 else []
    after = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    written = [path for path in after if after[path] != before.get(path)]
    left = [path.name for path in written if not may_be_left(path, code, made.arguments)]
    if code not in (DONE, CHECK_FAILED) and (left or set(before) - set(after)):
        faults.append(f"files of a failed command: {left}")
    if code == DONE and "--json" in made.arguments:
        faults += malformed("answer.json", stdout.encode())
    elif code == DONE and not any(re.search(rb"\b(nan|inf)\b", content) for content in made.files.values()):
        # A number is none of these in an input that is accepted, but a title or the name of a shot may be.
        faults += ["nan or inf in the answer"] if re.search(r"(?<![\w\"'=.-])[-+]?(nan|inf)(?![\w\"'])", stdout) else []
    for path in written if code in (DONE, CHECK_FAILED) else ():
        faults += malformed(path.name, path.read_bytes())
    return Outcome(code, seconds, usage.ru_maxrss / 1024, faults, stderr)


def may_be_left(path: Path, code: int, arguments: list[str]) -> bool:
    """Return whether a command that fails may leave a file, as the pages say."""
    is_map = code == NO_ANSWER and arguments[0] == "optimise"  # of how far the designs are from what is required
    is_mistakes = code == WRONG_INPUT and path.read_bytes().startswith(BEGINNING)  # as JUnit XML
    return is_map or is_mistakes or path.suffix == ".lock"


def in_child(made: Trial, folder: Path) -> int:
    """Run the command line in this process and return its exit code."""
    from armour.cli.main import main as armour

    os.chdir(folder)
    os.dup2(os.open(folder.parent / "in", os.O_RDONLY), 0)
    for descriptor, name in ((1, "out"), (2, "err")):
        os.dup2(os.open(folder.parent / name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), descriptor)
    signal.setitimer(signal.ITIMER_PROF, LIMIT_S * available_cores())
    signal.alarm(HANGING_S)
    sys.argv = ["armour", *made.arguments]
    try:
        armour()
    except SystemExit as end:
        return int(end.code or 0)
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
    return ERROR


def warm_up() -> None:
    """Import all that the commands need, so that each trial starts with it, and list the commands."""
    from typer.testing import CliRunner

    from armour.cli.app import COMMANDS as SHOWN
    from armour.cli.app import app, told

    examples = [example for group in SHOWN.values() for command in group for example in told(command)[1]]
    for example in (*examples, "armour optimise wilkins --map m.html"):
        with tempfile.TemporaryDirectory() as folder, chdir(folder):
            CliRunner().invoke(app, example.removeprefix("armour "))
    EARLIER.append(CliRunner().invoke(app, "check wilkins --json").stdout.replace("wilkins", "s.toml").encode())
    import pyarrow.csv
    import pyarrow.parquet  # noqa: F401

    COMMANDS.update({name: command.params for name, command in commands()})


def malformed(name: str, content: bytes) -> list[str]:
    """Return what is wrong with an output."""
    ending = Path(name).suffix
    text = content.decode("utf-16" if content.startswith(codecs.BOM_UTF16_LE) else "utf-8", "replace")
    try:
        if ending in (".svg", ".xml"):
            ElementTree.fromstring(content)
        elif ending in (".json", ".ipynb"):
            json.loads(text)
    except (ElementTree.ParseError, ValueError) as error:
        return [f"{name}: {error}"[:80]]
    faults = ["a script of the input"] if ending == ".html" and SCRIPT in text else []
    faults += ["nan or inf"] if ending in NOT_A_NUMBER and re.search(NOT_A_NUMBER[ending], text) else []
    return [f"{name}: {fault}" for fault in faults]


def main() -> int:
    """Run the trials and print what was wrong."""
    options = asked(__doc__, trials=20_000, seed=1)
    warm_up()
    codes: defaultdict[str, Counter[int]] = defaultdict(Counter)
    kinds: Counter[str] = Counter()
    given: set[tuple[str, str]] = set()
    slowest = largest = 0.0
    with ProcessPoolExecutor(available_cores(), get_context("fork")) as pool:
        trials = pool.map(partial(tried, options.seed), range(options.trials), chunksize=10)
        for number, (made, outcome) in enumerate(trials):
            codes[made.command][outcome.code] += 1
            given |= {(made.command, word) for word in made.arguments if word.startswith("--")}
            slowest, largest = max(slowest, outcome.seconds), max(largest, outcome.mib)
            kinds.update({f"{made.command}: {re.sub(r'[0-9]+', '#', fault)}" for fault in outcome.faults})
            if outcome.faults:
                print(number, *made, *outcome, flush=True)
    for command, found in sorted(codes.items()):
        ends = ", ".join(f"exit code {code}: {count}" for code, count in sorted(found.items()))
        print(f"{command:20} {ends}")
        if found.total() > FEW and not found[DONE]:
            kinds[f"{command}: never ended with exit code 0"] += 1
    for kind, count in kinds.most_common():
        print(f"{count} times: {kind}")
    ended = sum(codes.values(), Counter())
    return verdict(
        f"{ended.total():,} trials of {len(codes)} commands with {len(given)} options, {ended[DONE]:,} of which "
        f"ended with exit code 0: {kinds.total()} faults; at most {slowest:.0f} s and {largest:.0f} MiB",
        right=not kinds,
    )


def tried(seed: int, number: int) -> tuple[Trial, Outcome]:
    """Make and run a trial."""
    made = trial(Dice(f"{seed} {number}"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "work"
        folder.mkdir()
        return made, run(made, folder)
