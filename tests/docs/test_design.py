"""What docs/design.md says of modules: which there are, in which package, and what the core imports."""

import ast
import re
import sys
from pathlib import Path

import armour

ROOT = Path(__file__).parent.parent.parent
PAGE = (ROOT / "docs" / "design.md").read_text()
PACKAGE = Path(armour.__file__).parent
# Lines of each package, which starts at the margin; "" has the modules in no package.
BLOCK = re.split(r"^(\w+)/ ", PAGE.split("```")[1], flags=re.MULTILINE)
PACKAGES = {"": BLOCK[0], **dict(zip(BLOCK[1::2], BLOCK[2::2], strict=True))}


def test_every_module_is_on_the_page_in_its_package():
    missing = []
    for path in PACKAGE.rglob("*.py"):
        inside = path.relative_to(PACKAGE)
        # Modules of views/ and pictures/ are described together.
        place = PAGE if len(inside.parts) > 2 else PACKAGES.get(inside.parent.name, "")
        if not re.search(rf"\b{path.name}\b", place) and path.name not in ("__init__.py", "__main__.py"):
            missing.append(inside.as_posix())
    assert missing == []


def test_every_module_on_the_page_exists():
    for package, text in {**PACKAGES, "": PAGE}.items():
        names = {path.name for path in (PACKAGE / package).rglob("*.py")}
        assert sorted(set(re.findall(r"\b(\w+\.py)\b", text)) - names) == []


def test_every_path_on_the_page_exists():
    paths = re.findall(
        r"`((?:src|tests|docs|tools|suites|configs|scenarios|core|engine|scenario|analysis|design|cli)/[\w./-]+)`", PAGE
    )
    assert paths
    for path in paths:
        in_package = PACKAGE / path.removeprefix("src/armour/")  # installed, it is elsewhere
        assert (ROOT / path).exists() or in_package.exists() or "<" in path, path


def test_the_core_imports_the_standard_library_only():
    imported = set()
    for path in (PACKAGE / "core").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(f"{'.' * node.level}{node.module}")
    others = {name for name in imported if name.partition(".")[0] not in sys.stdlib_module_names}
    assert {name for name in others if not name.startswith("armour.core")} == set()
