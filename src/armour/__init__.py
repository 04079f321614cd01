"""Predict whether a ceramic/metal light armour stops a projectile, and find the lightest armour that does.

The public names are those in the stub file ``__init__.pyi``; each is imported on first use.

>>> from armour import load_scenario, simulate
>>> simulate(load_scenario("wilkins")).outcome
'perforated'
"""

__version__ = "2.1.0"
# First number: the equations and their interpretation. Second number: any change of the computed digits.
MODEL_VERSION = "1.5"


def __getattr__(name: str) -> object:
    """Attach the public names on the first use of one, which the command line can start without."""
    from importlib import import_module

    import lazy_loader

    from armour.analysis.results import Result

    # A notebook shows a result as its tables, which belong to a layer above the results: the layers meet here.
    Result._in_html = lambda result: import_module("armour.reporting.show").in_html(result)
    get, listed, names = lazy_loader.attach_stub(__name__, __file__)
    globals().update(__getattr__=get, __dir__=listed, __all__=names)
    return names if name == "__all__" else get(name)


def __dir__() -> list[str]:
    return list(__getattr__("__all__"))
