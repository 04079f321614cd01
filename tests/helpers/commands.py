"""Commands that are run in this process, or several in another one."""

import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from typer.main import get_command
from typer.testing import CliRunner, Result

from armour.cli.app import app

COMMAND = get_command(app)


def options_of(command: Any, words: str = "") -> Iterator[tuple[str, list[str]]]:
    """Yield the words of a command and of those in it, each with its options, such as "--verbose/-v"."""
    yield words, ["/".join(each.opts) for each in command.params if each.param_type_name == "option"]
    for name, inner in getattr(command, "commands", {}).items():
        yield from options_of(inner, f"{words} {name}".strip())


def invoke(words: Sequence[str], stdin: str | bytes | None = None, env: Mapping[str, str] | None = None) -> Result:
    """Run a command as typer's `CliRunner` does, which would make all commands anew each time."""
    runner = CliRunner(env=env)
    code, typed = 0, sys.argv
    raised: BaseException | None = None
    with runner.isolation(stdin) as streams:
        sys.argv = ["armour", *map(str, words)]
        try:
            COMMAND.main(args=[*words], prog_name="armour")
        except SystemExit as end:
            code, raised = int(end.code or 0), end
        except Exception as error:
            code, raised = 1, error
        finally:
            sys.argv = typed
        sys.stdout.flush()
        sys.stderr.flush()
        out, err, both = (stream.getvalue() for stream in streams)
    return Result(runner, out, err, both, None, code, raised if code else None)


IN_A_ROW = """
import sys, shlex
from armour.cli.main import main
for line in sys.argv[1:]:
    sys.argv = ["armour", *shlex.split(line)]
    try:
        main()
    except SystemExit as end:
        print(f"exit code {end.code or 0}: {line}", file=sys.stderr)
"""


def run_in_a_row(lines: Iterable[str], folder: Path, env: Mapping[str, str]) -> tuple[dict[str, int], str]:
    """Run commands in one new process, in a folder; their exit codes, and all that is printed."""
    command = [sys.executable, "-P", "-c", IN_A_ROW, *lines]
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False, timeout=120)
    ends = (line.removeprefix("exit code ").split(": ", 1) for line in done.stderr.splitlines() if line[:5] == "exit ")
    return {line: int(code) for code, line in ends}, done.stdout + done.stderr
