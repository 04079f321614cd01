"""Predict whether a ceramic/metal light armour stops a projectile, and find the lightest armour that does.

The public names are those in the stub file ``__init__.pyi``; each is imported on first use.

>>> from armour import load_scenario, simulate
>>> simulate(load_scenario("wilkins")).outcome
'perforated'
"""

from collections.abc import Callable
from functools import cache

__version__ = "3.0.0"
# First number: the equations and their interpretation. Second number: any change of the computed digits.
MODEL_VERSION = "1.7"


@cache
def _public() -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """Return the functions that get a public name and that list all, and the list; made on the first use of a name.

    The command line starts without them.
    """
    import lazy_loader

    return lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    get, _, names = _public()
    return names if name == "__all__" else get(name)


def __dir__() -> list[str]:
    return _public()[1]()
