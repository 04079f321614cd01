"""Penetration model: floats and named tuples in SI units and the symbols of the paper.

``state`` defines the symbols, ``equations`` has one function per relation, ``stages`` selects the equations that
hold, ``rk4`` takes a step, ``stepping`` chooses its length, ``events`` ends a stage, ``run`` integrates an impact
and ``search`` finds ballistic limits and thicknesses.  The core depends on the standard library only.
"""
