"""The penetration model: floats and named tuples in SI units, in the symbols of the paper.

Nothing here knows a file, the name of a material or how a result is shown.  ``state`` holds the symbols,
``equations`` one relation per function, ``stages`` which of them hold and until when, ``rk4`` a step and
``run`` an impact from its start to its end.
"""
