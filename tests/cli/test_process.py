"""The installed command as a process of its own."""

import codecs
import os
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from io import TextIOWrapper
from pathlib import Path

import pytest

from armour import MODEL_VERSION, __version__
from armour.cli.app import app
from armour.cli.main import _plain
from tests.helpers.cases import SCENARIOS
from tests.helpers.commands import IN_A_ROW, run_in_a_row

pytestmark = pytest.mark.slow

REPOSITORY = SCENARIOS.parent
# Imported by no command but those that plot or keep a history.
HEAVY = ["matplotlib", "numpy", "scipy"]
# Imported by no command but those that read a scenario or the library.
READING = ["pydantic"]


def process(*args: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, stdin=subprocess.DEVNULL, check=False)


def test_python_m(tmp_path: Path):
    result = process("-m", "armour", "--version", cwd=tmp_path)
    assert result.stdout == f"armour {__version__}, model {MODEL_VERSION}\n"


# Imported by no command but those that answer these questions.
OTHERS = [
    "armour.statistics.calibration",
    "armour.validation.validate",
    "armour.design.optimise",
    "armour.sweeps.sweep",
]


@pytest.mark.parametrize(
    ("args", "not_needed"),
    [
        (["--help"], HEAVY + READING),
        (["simulate", SCENARIOS / "wilkins.toml"], ["matplotlib", *OTHERS]),
        (["optimise", SCENARIOS / "catalogue.toml"], ["matplotlib", "scipy.stats"]),
        (["library"], HEAVY + OTHERS),
    ],
)
def test_nothing_is_imported_before_it_is_needed(args: list[object], not_needed: list[str]):
    code = f"""
import sys
sys.argv = ["armour", *{[str(arg) for arg in args]!r}]
from armour.cli.main import main
try:
    main()
except SystemExit as end:
    assert not end.code
print([name for name in {not_needed!r} if name in sys.modules], file=sys.stderr)
"""
    assert process("-c", code).stderr.splitlines()[-1] == "[]"


def piped(args: str, cwd: Path) -> tuple[int, str, str]:
    """Exit code, output and messages of a command whose reader takes one line and goes."""
    # The reader waits for the first block, so that the command finds the pipe closed at the next one.
    reader = f"{sys.executable} -c 'import sys; print(sys.stdin.readline(), end=str())'"
    command = f"{sys.executable} -u -m armour {args} | {reader}; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False, cwd=cwd)
    return done.returncode, done.stdout, done.stderr


@pytest.fixture
def unread() -> Iterator[TextIOWrapper]:
    """A pipe that nobody reads."""
    read, written = os.pipe()
    os.close(read)
    with os.fdopen(written, "w") as stream:
        yield stream


@pytest.mark.parametrize("args", ["--help", "library"])
def test_a_closed_pipe_is_no_error(args: str, unread: TextIOWrapper):
    command = [sys.executable, "-m", "armour", args]
    done = subprocess.run(command, stdout=unread, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.fixture
def into_the_pipe(
    unread: TextIOWrapper, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[[str], tuple[object, str]]:
    """Exit code and messages of a command of this process that writes to a pipe that nobody reads."""

    def run(args: str) -> tuple[object, str]:
        monkeypatch.setattr(sys, "stdout", unread)
        with pytest.raises(SystemExit) as end:
            app(shlex.split(args), prog_name="armour")
        return end.value.code, capsys.readouterr().err

    return run


@pytest.mark.usefixtures("folder")
def test_a_reader_that_goes_away_costs_no_file_and_no_warning(into_the_pipe: Callable[[str], tuple[object, str]]):
    code, messages = into_the_pipe("simulate unknown_ceramic --history h.csv --plot p.svg")
    assert code == 0
    assert messages.splitlines()[:2] == ["wrote h.csv", "wrote p.svg"]
    assert [line.startswith("warning: ") for line in messages.splitlines()[2:]] == [True]
    assert Path("p.svg").exists()


def test_a_failed_check_is_told_through_a_closed_pipe(into_the_pipe: Callable[[str], tuple[object, str]]):
    suite = REPOSITORY / "tests" / "validation" / "regression.toml"
    assert into_the_pipe(f"validate {suite} --only dwell --set impact.velocity_m_s=500") == (3, "")


@pytest.mark.parametrize("module", ["armour.cli.app", "pydantic"])
def test_interrupted_while_it_starts(module: str):
    code = f"""
import sys
class Interrupt:
    def find_spec(self, name, *_):
        if name == {module!r}:
            raise KeyboardInterrupt
from armour.cli.main import main
sys.meta_path.insert(0, Interrupt())
sys.argv = ["armour", "simulate", "a.toml"]
main()
"""
    done = process("-c", code)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")


@pytest.mark.parametrize("module", ["armour.cli.app", "armour.scenario.scenario"])
def test_terminated_it_ends_like_an_interrupted_one(module: str):
    code = f"""
import os, signal, sys
class Terminate:
    def find_spec(self, name, *_):
        if name == {module!r}:
            os.kill(os.getpid(), signal.SIGTERM)
from armour.cli.main import main
sys.meta_path.insert(0, Terminate())
sys.argv = ["armour", "simulate", "wilkins"]
main()
"""
    done = process("-c", code)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


def test_interrupted_in_a_destructor_which_loses_exceptions():
    code = """
import sys
class Lost:
    def __del__(self):
        raise KeyboardInterrupt
class Import:
    def find_spec(self, name, *_):
        if name == "pydantic":
            Lost()
from armour.cli.main import main
sys.meta_path.insert(0, Import())
sys.argv = ["armour", "simulate", "a.toml"]
main()
"""
    done = process("-c", code)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")


def test_interrupted_where_a_library_makes_its_own_error_of_it():
    code = """
import os, signal, sys, types
def app(**_):
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        raise ValueError("no schema") from None
sys.modules["armour.cli.app"] = types.SimpleNamespace(app=app)
from armour.cli.main import main
main()
"""
    done = process("-c", code)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")


def test_one_line_of_a_pipe(tmp_path: Path):
    code, output, messages = piped(f"simulate {SCENARIOS / 'wilkins.toml'}", tmp_path)
    assert (code, output, messages) == (0, "perforated by the model: 277 m/s left of 800 m/s\n", "")


@pytest.mark.parametrize("encoding", ["ascii", "cp437"])
def test_an_encoding_without_rules_or_units(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoding: str):
    monkeypatch.setenv("PYTHONIOENCODING", encoding)
    lines = [sys.executable, "-c", IN_A_ROW, "check oblique", "check é°─Ω"]
    done = subprocess.run(lines, capture_output=True, cwd=tmp_path, check=False)
    shown, said = done.stdout.decode(encoding), done.stderr.decode(encoding)
    named = {"ascii": "? deg-?", "cp437": "é°─Ω"}[encoding]
    assert f"\n{named}: cannot be read" in said
    rule, angle = ("─" if encoding == "cp437" else "-"), (" deg" if encoding == "ascii" else "°")
    assert any(line and set(line) == {rule} for line in shown.splitlines())
    assert f" 30{angle} " in shown


CODE_PAGES = (37, 437, 850, 852, 866, 874, 932, 936, 949, 950, *range(1250, 1259))
ENCODINGS = [
    *(f"cp{number:03}" for number in CODE_PAGES),
    "ascii",
    "latin-1",
    "koi8-r",
    "mac-roman",
    "gb18030",
    "shift_jis",
    "euc-jp",
    "utf-16",
]


def test_every_encoding_has_characters_for_what_is_printed():
    codecs.register_error("plain", _plain)
    sessions = "".join(path.read_text(encoding="utf-8") for path in (REPOSITORY / "tests/cli/golden").iterdir())
    # rich draws boxes by other characters itself.
    special = "".join(character for character in {*sessions} - {*"╭╮╰╯│"} if not character.isascii())
    for encoding in ENCODINGS:
        assert not {*"?\\"} & {*special.encode(encoding, "plain").decode(encoding)}, encoding


# Variables that libraries read, where an answer is computed, shown or drawn.
VARIABLES = (
    *("SOURCE_DATE_EPOCH", "MPLBACKEND", "MATPLOTLIBRC", "MPL_IGNORE_SYSTEM_FONTS", "COLUMNS", "LINES"),
    *("TERM", "COLORTERM", "NO_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE", "JUPYTER_COLUMNS"),
    *("JUPYTER_LINES", "UNICODE_VERSION", "DATABRICKS_RUNTIME_VERSION", "TERMINAL_WIDTH"),
    *("TYPER_USE_RICH", "TYPER_STANDARD_TRACEBACK", "_TYPER_STANDARD_TRACEBACK"),
    *("_TYPER_FORCE_DISABLE_TERMINAL", "EAGER_IMPORT", "NUMPY_MADVISE_HUGEPAGE", "NPY_PROMOTION_STATE"),
    *("SCIPY_ARRAY_API", "SCIPY_DEVICE", "PRIMA_DEBUGGING", "PSUTIL_DEBUG", "PYDANTIC_DISABLE_PLUGINS"),
    *("PYDANTIC_PRIVATE_ALLOW_UNHANDLED_SCHEMA_TYPES", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"),
    *("OPENBLAS_CORETYPE", "GOTO_NUM_THREADS", "MKL_NUM_THREADS", "LANG", "LC_ALL", "TZ", "TMPDIR"),
    *("XDG_DATA_DIRS", "XDG_DATA_HOME", "WINDIR"),
)
ENVIRONMENTS = {
    "empty": ("", VARIABLES),
    "a word": ("x", VARIABLES[1:]),
    "huge": ("9" * 25, VARIABLES[1:]),
    "negative": ("-1", VARIABLES[1:]),
    "one": ("1", [name for name in VARIABLES if name not in ("COLUMNS", "TTY_COMPATIBLE")]),
    "no digit": ("²", VARIABLES[1:]),
}


@pytest.mark.parametrize(("value", "names"), ENVIRONMENTS.values(), ids=ENVIRONMENTS)
def test_what_the_environment_says_to_libraries_changes_nothing(value: str, names: Sequence[str], tmp_path: Path):
    lines = ("check wilkins", "simulate wilkins --plot run.pdf", "v50 --help", "v50 tests/shots --plot v50.svg")
    before = run_in_a_row(lines, tmp_path, os.environ)
    (tmp_path / "run.pdf").unlink()
    (tmp_path / "v50.svg").unlink()
    assert run_in_a_row(lines, tmp_path, {**os.environ, **dict.fromkeys(names, value)}) == before
    assert before[0] == dict(zip(lines, (3, 0, 0, 0), strict=True))


def test_numbers_do_not_depend_on_the_threads_of_the_linear_algebra(cli, folder: Path, monkeypatch: pytest.MonkeyPatch):
    plan = ("plan", "shots", "wilkins", "--json")
    here = os.environ["OPENBLAS_NUM_THREADS"]
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2" if here == "1" else "1")
    assert process("-m", "armour", *plan, cwd=folder).stdout == cli(*plan).stdout != ""
