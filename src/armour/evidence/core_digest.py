"""Tell whether the equations are those that the shipped tests were computed with, by a digest of the core's code."""

from functools import cache
from hashlib import sha256
from pathlib import Path

from armour.core import state
from armour.engine.changes import changed_names
from armour.evidence.fit import shipped_data

CORE_FOLDER = Path(state.__file__).parent


def changed_equations() -> str:
    """Describe the equations if they are not those that the shipped tests were computed with; "" if they are."""
    if names := changed_names():
        return f"{names} changed"
    return "" if core_digest() == shipped_data()["core"]["sha256"] else "the equations as they are in armour/core"


@cache
def core_digest(core: Path = CORE_FOLDER) -> str:
    """Return a hash of the code in the folder of the core; comments, docstrings and layout do not count.

    Without source files, it is the hash of no code, which differs from that stored with the tests.
    """
    import ast  # slow to import

    content = sha256()
    for path in sorted(core.glob("*.py")):
        tree = ast.parse(path.read_bytes())
        for node in ast.walk(tree):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
                del node.body[0]
        content.update(sha256(f"{path.name}\n{ast.unparse(tree)}".encode()).digest())
    return content.hexdigest()
