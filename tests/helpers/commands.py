"""Commands that are run in this process."""

import sys
from collections.abc import Mapping, Sequence

from typer.main import get_command
from typer.testing import CliRunner, Result

from armour.cli.app import app

COMMAND = get_command(app)


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
