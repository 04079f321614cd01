"""The public names."""

import pkgutil
import types

import pytest

import armour


def test_all_is_sorted_and_there():
    assert armour.__all__ == sorted(armour.__all__)
    for name in armour.__all__:
        thing = getattr(armour, name)
        assert not isinstance(thing, types.ModuleType), name
        assert thing.__doc__, name


def test_every_public_name_has_its_home():
    assert sorted(armour._HOMES) == armour.__all__
    assert set(armour.__all__) <= set(dir(armour))


def test_no_module_hides_a_public_name():
    for module in pkgutil.iter_modules(armour.__path__):
        assert module.name not in armour.__all__


def test_a_name_that_is_not_there():
    with pytest.raises(AttributeError, match="fly"):
        armour.fly  # noqa: B018
