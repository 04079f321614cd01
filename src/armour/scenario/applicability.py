"""Applicability of the model: where an armour lies outside what was tested, and the error of its ballistic limit."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, cast

from armour.core.state import Parameters
from armour.scenario.evidence import CERAMICS, COVERED, EVIDENCE, LAW_MEASURES, Evidence, ModelError
from armour.scenario.inputs import VELOCITY

# Factor by which a quantity of an unusual armour lies outside of all that the model was compared with.
FAR = 2.0


class Limit(NamedTuple):
    """A respect in which an armour, or each of n, may lie outside what the model was compared with."""

    key: str
    words: str  # what the model was compared with
    outside: Any  # bool or array of bool, (n,)
    value: Any = None  # number or array, (n,); None where the name of the ceramic tells it


def error_on_tests(armour: Parameters) -> ModelError | None:
    """Return the error of the ballistic limit on tests of such armours; None if there are none."""
    evidence = closest(armour)
    if any(limits.fails(armour) for limits in evidence.kind):
        return None
    extrapolated = tuple(str(limits) for limits in evidence.measured if limits.fails(armour))
    return ModelError(*evidence.error, evidence.title, extrapolated)


def closest(armour: Parameters) -> Evidence:
    """Return the evidence whose kind of armour and penetrator an armour differs from in the fewest respects."""
    known = [evidence for evidence in EVIDENCE if evidence.bare == (armour.Hc0 == 0.0)]
    return min(known, key=lambda evidence: sum(bool(limits.fails(armour)) for limits in evidence.kind))


def is_unusual(armour: Parameters) -> Any:
    """Return whether an armour, or each of n, is far from all of its kind that the model was compared with.

    A strength, a density, the slenderness or a thickness over the diameter is then outside by more than a factor of
    two, and the outcome may change more than once with the velocity or a thickness.  A NaN is not outside.
    """
    found = False
    for bare, ranges in COVERED.items():
        for limits in ranges:
            value = limits.measure.of(armour)
            outside = (value < limits.low / FAR) | (value > limits.high * FAR)
            found = found | (outside & ((armour.Hc0 == 0.0) == bare))
    return found


def armour_warnings(
    armour: Parameters, ceramic: str | None, velocity: float, keys: Mapping[str, str]
) -> tuple[str, ...]:
    """Return the ways in which an armour is unlike what the model was compared with, as "key: what, value found".

    `ceramic` is the name of its ceramic, and `keys` are keys to name in place of others.
    """
    outside = (limit for limit in limits_of(closest(armour), armour, velocity) if limit.outside)
    return tuple(
        f"{keys.get(limit.key, limit.key)}: {limit.words}, found {_found(ceramic, limit)}" for limit in outside
    )


def _found(ceramic: str | None, limit: Limit) -> str:
    if limit.value is None:
        return f'"{ceramic}"'
    return f"{limit.value:.0f}" if limit.value >= 100.0 else f"{limit.value:.3g}"


def limits_of(evidence: Evidence, armour: Parameters, velocity: Any) -> Iterator[Limit]:
    """Give the limits of some evidence, and whether an armour and a velocity, or each of many, lie outside them.

    The velocity is None where none is to be compared.
    """
    if velocity is not None:
        low, high = evidence.velocities_m_s
        words = f"the model was compared with results at {low:g} to {high:g} m/s"
        yield Limit(VELOCITY, words, (velocity < low) | (velocity > high), velocity)
    if not evidence.bare:
        yield from _of_ceramic(evidence, armour)
    for limits in evidence.ranges():
        words = f"the model was compared with results for {limits}"
        yield Limit(limits.measure.key, words, limits.fails(armour), limits.measure.of(armour))


def _of_ceramic(evidence: Evidence, armour: Parameters) -> Iterator[Limit]:
    """Give the limits of the ceramics that were tested, or that the paper's program computed."""
    untested = unknown = True
    for ceramic in CERAMICS:
        density, modulus = ceramic.ranges()
        different = density.fails(armour) | modulus.fails(armour)
        unknown = unknown & different
        if ceramic.measured:
            untested = untested & different
        words = f"the model was compared with results of {ceramic.name} with {ceramic.strength}"
        measure = ceramic.strength.measure
        yield Limit(measure.key, words, ceramic.strength.fails(armour) & (different ^ True), measure.of(armour))
    other = False
    for limits in evidence.kind:
        if limits.measure in LAW_MEASURES:
            other = other | limits.fails(armour)
    yield Limit("armour.ceramic", "the model was compared with no test by such a law of the flow stress", other)
    names = ", ".join(ceramic.name for ceramic in CERAMICS)
    yield Limit("armour.ceramic", f"the model was compared with results of {names} only", unknown)
    words = "the model was compared with results of the paper's program for such a ceramic, with no test"
    yield Limit("armour.ceramic", words, untested ^ unknown)


def row_errors(armour: Any) -> ModelError:
    """Return the errors of n armours from tests of such armours, (n,) each; NaN where unknown."""
    # Imported here because a scenario without rows does not need numpy.
    import numpy as np

    found = np.full((3, len(armour.Hc0)), np.nan)
    for evidence in EVIDENCE:
        of_kind = evidence.bare == (armour.Hc0 == 0.0)
        for limits in evidence.kind:
            of_kind &= ~limits.fails(armour)
        found[:, of_kind] = np.array(evidence.error)[:, None]
    return ModelError(*(cast(Any, column) for column in found))


def row_limits(armour: Any, velocities: Any) -> Iterator[tuple[str, int]]:
    """Yield the limits, as "key: words", that some of n armours lie outside of, and how many do.

    The parameters of the armours are arrays, (n,), as are velocities, which are None where none are to be compared.
    """
    import numpy as np

    fails = [sum(limits.fails(armour).astype(int) for limits in evidence.kind) for evidence in EVIDENCE]
    other = [1000 * (evidence.bare != (armour.Hc0 == 0.0)) for evidence in EVIDENCE]
    nearest = (np.array(fails) + np.array(other)).argmin(axis=0)
    for index in np.unique(nearest):
        where = nearest == index
        some = Parameters(*(values[where] for values in armour))
        for limit in limits_of(EVIDENCE[index], some, None if velocities is None else velocities[where]):
            count = int(np.count_nonzero(limit.outside))
            if count:
                yield f"{limit.key}: {limit.words}", count
