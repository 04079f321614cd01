"""Names that commands need to compute, but not for their help: each is imported on first use.

The stub file ``lazy.pyi`` lists the names.  Write ``import armour.lazy as lazy``: ``from armour import lazy`` would
first look for a public name, which is slow.
"""


def __getattr__(name: str) -> object:
    """Attach the names on the first use of one."""
    import lazy_loader

    get, _, _ = lazy_loader.attach_stub("armour", __file__)
    globals()["__getattr__"] = get
    return get(name)
