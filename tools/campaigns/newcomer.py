"""Run every example of the pages and of the help from a wheel, each in an empty folder.

The tests of the examples, each of which works in a folder of its own, are run with the unpacked wheel in place of the
sources.

    python -m tools.campaigns.newcomer
"""

import os
import subprocess
import sys
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory

from tools.campaigns.verdict import verdict

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLES = ("tests/cli/test_docs.py", "tests/cli/test_habits.py", "tests/cli/test_notebook.py")


def main() -> int:
    """Build and unpack the wheel, and return the exit code of the tests with it."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        build = ["-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet", "-w", name, str(REPOSITORY)]
        subprocess.run([sys.executable, *build], check=True)
        [wheel] = folder.glob("*.whl")
        zipfile.ZipFile(wheel).extractall(folder / "site")
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder / "site"), str(REPOSITORY)])}
        where = [sys.executable, "-c", "import armour; print(armour.__file__)"]
        found = subprocess.run(where, env=environment, cwd=folder, capture_output=True, text=True, check=True)
        if not found.stdout.startswith(name):
            print(f"armour is not that of the wheel: {found.stdout}", end="")
            return 1
        tests = [sys.executable, "-m", "pytest", "-o", "addopts=", "-n0", "--tb=short", "-q", *EXAMPLES]
        done = subprocess.run(tests, env=environment, cwd=REPOSITORY, check=False, stdout=subprocess.PIPE, text=True)
        print(done.stdout, end="")
        return verdict(f"tests of the examples: {done.stdout.strip().splitlines()[-1]}", right=not done.returncode)


if __name__ == "__main__":
    sys.exit(main())
