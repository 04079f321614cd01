"""Predict whether a ceramic/metal light armour stops a projectile, and find the lightest armour that does.

The public names are those in the stub file ``__init__.pyi``; each is imported on first use.

>>> from armour import load_scenario, simulate
>>> simulate(load_scenario("scenarios/wilkins.toml")).outcome
'perforated'
"""

import lazy_loader

__version__ = "0.1.0"
# First number: the equations and their interpretation. Second number: any change of the computed digits.
MODEL_VERSION = "1.1"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
