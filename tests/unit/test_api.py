"""The public names."""

import types

import armour


def test_all_is_sorted_and_there():
    assert armour.__all__ == sorted(armour.__all__)
    for name in armour.__all__:
        thing = getattr(armour, name)
        assert not isinstance(thing, types.ModuleType), name
        assert thing.__doc__, name
