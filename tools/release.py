"""Build sdist and wheels of this version, check them in a clean environment, and leave them in dist/.

``make release`` runs it. It uploads nothing.
"""

import os
import re
import runpy
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
[VERSION] = re.findall(r'^__version__ = "(.+)"$', (ROOT / "src/armour/__init__.py").read_text(encoding="utf-8"), re.M)
TAG = f"v{VERSION}"


def changelog() -> list[tuple[str, str]]:
    """Return the headings of the changelog, "Unreleased" first, with what is under them."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    return re.findall(r"^## ([^\n]+)\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)


def disagreements() -> list[str]:
    """Return where the changelog and CITATION.cff do not fit the version."""
    heading = changelog()[1][0]
    if (found := re.fullmatch(rf"{re.escape(VERSION)} \((\d{{4}}-\d\d-\d\d)\)", heading)) is None:
        return [f"CHANGELOG.md: the first version must be {VERSION}, with its date, found {heading}"]
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    expected = [f"version: {VERSION}", f"date-released: {found[1]}"]
    return [f"CITATION.cff: must have the line {line}" for line in expected if line not in lines]


def unfinished() -> list[str]:
    """Return what is missing for a release of this commit."""
    found = disagreements()
    (_, unreleased), *_ = changelog()
    if unreleased.strip():
        found.append("CHANGELOG.md: Unreleased: must be empty; its changes belong to the version")
    if changed := output("git", "status", "--porcelain"):
        found.append(f"the tree must be clean, found\n{changed}")
    tagged = output("git", "tag", "--list", TAG) and output("git", "rev-list", "-1", TAG)
    if tagged not in ("", output("git", "rev-parse", "HEAD")):
        found.append(f"the tag {TAG} must be this commit, found {tagged}")
    return found


def output(*command: object, cwd: Path = ROOT, env: dict[str, str] | None = None) -> str:
    """Return what a command prints; it must succeed."""
    done = subprocess.run(list(map(str, command)), cwd=cwd, env=env, stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout.strip()


def run(*command: object, cwd: Path, env: dict[str, str] | None = None) -> None:
    """Run a command that must succeed, and show what it prints."""
    print("$", *command, flush=True)
    subprocess.run(list(map(str, command)), cwd=cwd, env=env, check=True)


def built(folder: Path) -> tuple[Path, list[Path]]:
    """Build the sdist, and from it a wheel for each system; return them, the wheel for most Linux machines first."""
    systems = runpy.run_path(str(ROOT / "hatch_build.py"))["SYSTEMS"]
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", folder]
    run(*build, "--sdist", cwd=ROOT)
    [sdist] = folder.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        archive.extractall(folder / "source", filter="data")
    [source] = (folder / "source").iterdir()
    for tag in systems:
        run(*build, "--wheel", cwd=source, env={**os.environ, "ARMOUR_WHEEL_FOR": tag})
    wheels = [wheel for tag in systems for wheel in folder.glob(f"*-{tag}.whl")]
    return sdist, wheels


def check(sdist: Path, wheel: Path, folder: Path) -> None:
    """Install the wheel where nothing else is, use it, and run the tests of the sdist with it."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))}
    run(sys.executable, "-m", "venv", folder / "venv", cwd=folder)
    commands = folder / "venv" / ("Scripts" if os.name == "nt" else "bin")
    pip = [commands / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    run(*pip, wheel, cwd=folder, env=environment)
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, filter="data")
    [source] = folder.glob("armour_ballistics-*")
    # The tests must find the installed package.
    shutil.rmtree(source / "src")

    empty = folder / "empty"
    empty.mkdir()
    shown = output(commands / "armour", "--version", cwd=empty, env=environment)
    if not shown.startswith(f"armour {VERSION}, model "):
        sys.exit(f"{wheel.name}: armour --version must show {VERSION}, found {shown}")
    run(commands / "armour", "simulate", "wilkins", cwd=empty, env=environment)
    run(commands / "armour", "validate", cwd=empty, env=environment)
    run(commands / "armour", "validate", source / "tests/validation/regression.toml", cwd=empty, env=environment)

    run(*pip, f"{wheel}[dev,docs]", cwd=folder, env=environment)
    package = output(commands / "python", "-c", "import armour; print(armour.__file__)", cwd=source, env=environment)
    if not Path(package).is_relative_to(folder / "venv"):
        sys.exit(f"the tests must import the wheel, found {package}")
    run(commands / "python", "-m", "pytest", "-n", "auto", cwd=source, env=environment)


def main() -> None:
    """Build, check and keep the files of a release."""
    if found := unfinished():
        sys.exit("\n".join(found))
    with tempfile.TemporaryDirectory(prefix="armour-release-", ignore_cleanup_errors=True) as name:
        folder = Path(name).resolve()
        sdist, wheels = built(folder / "dist")
        run(sys.executable, "-m", "twine", "check", "--strict", sdist, *wheels, cwd=ROOT)
        check(sdist, wheels[0], folder)
        (ROOT / "dist").mkdir(exist_ok=True)
        kept = [Path(shutil.copy(file, ROOT / "dist")) for file in (sdist, *wheels)]
    print(f"\narmour {VERSION}: ready; tag the commit {TAG}")
    print("\n".join(f"{path.relative_to(ROOT)}  {path.stat().st_size / 1e3:.0f} kB" for path in kept))


if __name__ == "__main__":
    main()
