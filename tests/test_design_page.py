"""docs/design.md names the modules that there are, and no others."""

import re
from pathlib import Path

import armour

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "design.md").read_text()
PACKAGE = Path(armour.__file__).parent


def test_every_module_is_on_the_page():
    modules = [path for path in PACKAGE.rglob("*.py") if path.name not in ("__init__.py", "__main__.py")]
    named = [path for path in modules if re.search(rf"\b{path.name}\b", PAGE)]
    # The page describes the modules of tables together.
    missing = [
        path.relative_to(PACKAGE).as_posix() for path in set(modules) - set(named) if path.parent.name != "tables"
    ]
    assert missing == []


def test_every_module_on_the_page_exists():
    names = {path.name for path in PACKAGE.rglob("*.py")}
    named = set(re.findall(r"\b(\w+\.py)\b", PAGE))
    assert sorted(named - names) == []


def test_every_path_on_the_page_exists():
    paths = re.findall(
        r"`((?:src|tests|docs|tools|suites|configs|scenarios|core|engine|scenario|analysis|design|cli)/[\w./-]+)`", PAGE
    )
    assert paths
    for path in paths:
        in_package = PACKAGE / path.removeprefix("src/armour/")  # installed, it is elsewhere
        assert (ROOT / path).exists() or in_package.exists() or "<" in path, path
