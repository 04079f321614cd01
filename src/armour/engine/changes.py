"""Let a program change equations of the model for as long as a context lasts, and tell which are changed."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import wraps
from inspect import isfunction, signature
from threading import local
from types import ModuleType
from typing import Any

from armour.core import equations as model_equations
from armour.core import events, rk4, roots, run, search, stages, state
from armour.errors import Problem, choices, mistake, refuse

# Names of the equations that can be changed.
NAMES = [name for name, value in vars(model_equations).items() if isfunction(value)]
# The modules of the model.
MODULES = (state, model_equations, stages, roots, rk4, events, run, search)
# What each name of each module of the core must be.
_values: dict[ModuleType, dict[str, object]] = {module: dict(vars(module)) for module in MODULES}
_changed: list[str] = []


@contextmanager
def equations(**changed: Callable[..., float]) -> Iterator[None]:
    """Make a context in which equations of the model are changed.

    Everything is then computed in plain Python.  Results name the changed equations, and their probabilities are not
    known.  The change holds for all threads.

    Parameters
    ----------
    **changed : callable
        The functions to use, by the names of those of `armour.core.equations`, with the same arguments and units.
        Within such a function, the one in whose place it is stays callable under its own name.

    Raises
    ------
    InputError
        If a name is none of an equation, or a value is no function of its arguments.  Within the context: if a function
        returns no finite number.

    Examples
    --------
    >>> import armour
    >>> with armour.equations(crack_velocity=lambda Ec, rho_c: 0.5 * (Ec / rho_c) ** 0.5):
    ...     result = armour.ballistic_limit(armour.load_scenario("wilkins"))
    >>> result.warnings
    ('computed with crack_velocity changed',)
    """
    refuse(_mistakes(changed))
    checked = {name: _equation_with_check(name, function) for name, function in changed.items()}
    before, count = {name: getattr(model_equations, name) for name in checked}, len(_changed)
    # The bound on the energy, below which nothing is computed, is derived from the equations of the paper.
    bound = search.may_perforate
    _set(model_equations, checked)
    _set(search, {"may_perforate": lambda _p, _V: True})
    _changed.extend(changed)
    try:
        yield
    finally:
        _set(model_equations, before)
        _set(search, {"may_perforate": bound})
        del _changed[count:]


def changed_names() -> str:
    """Return the names of the equations that `equations` has changed, joined by "and"; "" if none is.

    Raise an InputError if anything else in the core is not what it was when it was imported.
    """
    for module, values in _values.items():
        for name, value in values.items():
            if getattr(module, name, None) is not value:
                way_on = f"use with armour.equations({name}=...)" if name in NAMES else "change it in a clone"
                raise mistake(f"{module.__name__}.{name}", "", f"has been replaced; {way_on}, or start Python again")
    return " and ".join(dict.fromkeys(_changed))


def _mistakes(changed: dict[str, Any]) -> Iterable[Problem]:
    """Yield what is wrong with changed equations, by name: those of no equation, and what is no function."""
    for name, value in changed.items():
        if name not in NAMES:
            yield Problem("equations", name, f"must be the name of an equation{choices(name, NAMES)}")
        elif not callable(value):
            yield Problem("equations", name, f"must be a function, found {value!r}")
        elif (found := _arguments(value)) not in (None, needed := _arguments(getattr(model_equations, name))):
            yield Problem("equations", name, f"must be a function of {needed}, in this order, found {found}")


def _arguments(function: Callable[..., Any]) -> str | None:
    """Return the names of the arguments of a function, as "V, U", or None if it takes any.

    An underscore before a name says that it is not used.
    """
    each = [one for one in signature(function).parameters.values() if one.kind is not one.VAR_KEYWORD]
    needed = ", ".join(one.name.lstrip("_") for one in each if one.default is one.empty)
    return None if any(one.kind is one.VAR_POSITIONAL for one in each) else needed


def _set(module: ModuleType, values: dict[str, Any]) -> None:
    """Set names of a module of the core to values, and let `changed_names` expect these there."""
    vars(module).update(values)
    _values[module].update(values)


def _equation_with_check(name: str, function: Callable[..., Any]) -> Callable[..., float]:
    """Return a changed equation that raises an InputError if it gives no finite number for finite arguments."""
    import numpy as np  # slow to import

    original: Callable[..., float] = getattr(model_equations, name)
    calling = local()

    @wraps(original)
    def call(*arguments: Any, **named: Any) -> float:
        if vars(calling):
            # The function calls the one in whose place it is.
            return original(*arguments, **named)
        calling.itself = True
        try:
            value = function(*arguments)
        finally:
            del calling.itself
        try:
            is_right = np.isrealobj(value) and (np.isfinite(value).all() or not np.isfinite(arguments).all())
        except TypeError:
            is_right = False
        if not is_right:
            raise mistake("equations", name, f"must return a finite number, found {value!r} for {arguments}")
        return value

    return call
