"""Names that commands need once they compute, which are more than help needs: each is imported on first use.

They are those in the stub file ``lazy.pyi``.  ``from armour import lazy`` would first look for a public name, which is
slow: ``import armour.lazy as lazy``.
"""


def __getattr__(name: str) -> object:
    """Attach the names on the first use of one."""
    import lazy_loader

    get, _, _ = lazy_loader.attach_stub("armour", __file__)
    globals()["__getattr__"] = get
    return get(name)
