"""The public names."""

import ast
import pkgutil
import subprocess
import sys
import types
from pathlib import Path

import pytest

import armour

STUB = Path(armour.__file__).with_suffix(".pyi")


def homes() -> dict[str, str]:
    """Module of every public name, as the stub has it."""
    imports = [node for node in ast.parse(STUB.read_text()).body if isinstance(node, ast.ImportFrom)]
    return {alias.name: f"armour.{node.module}" for node in imports for alias in node.names}


def test_the_public_names_are_those_of_the_stub():
    assert dir(armour) == sorted(homes())
    namespace: dict[str, object] = {}
    exec("from armour import *", namespace)
    assert namespace.keys() - {"__builtins__"} == homes().keys()


@pytest.mark.parametrize("name", sorted(homes()))
def test_every_public_name_is_defined_and_documented_in_its_module(name: str):
    thing = getattr(armour, name)
    assert not isinstance(thing, types.ModuleType)
    assert thing.__module__ == homes()[name]
    assert thing.__doc__


def test_versions():
    declared = [node for node in ast.parse(STUB.read_text()).body if isinstance(node, ast.AnnAssign)]
    names = [node.target.id for node in declared if isinstance(node.target, ast.Name)]
    assert names == ["__version__", "MODEL_VERSION"]
    assert all(isinstance(getattr(armour, name), str) for name in names)


def test_no_package_hides_a_public_name():
    assert not {module.name for module in pkgutil.iter_modules(armour.__path__)} & homes().keys()


def test_an_unknown_name():
    name = "fly"
    with pytest.raises(AttributeError, match=name):
        getattr(armour, name)


def test_the_package_is_marked_as_typed():
    assert STUB.with_name("py.typed").is_file()


def test_importing_armour_is_light():
    code = "import sys, armour; print([name for name in ('numpy', 'scipy', 'pydantic') if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout == "[]\n"
