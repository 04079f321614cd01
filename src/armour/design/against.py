"""Compare a check with an earlier one: what differs, and whether it weakens a requirement or a threat."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isclose
from typing import Any

from pydantic import BaseModel, TypeAdapter, ValidationError

from armour.errors import mistake

NO_BASE = "must be the output of armour check --json; one of an old version must be made again"
# Values in place of numbers, for a part of a check that only the earlier or the later one has.
PRESENT, MISSING = "present", "missing"


class _Limit(BaseModel, allow_inf_nan=False):
    """Greatest areal density, thickness or cost allowed, and that of the armour, as armour check --json prints them."""

    quantity: str
    required: float
    found: float | None


class _Threat(BaseModel, allow_inf_nan=False):
    """What armour check --json prints of an armour against a threat, and can be compared."""

    name: str
    projectile: str
    velocity_m_s: float
    obliquity_deg: float
    required_margin_m_s: float
    required_probability: float | None
    ballistic_limit_m_s: float | None
    probability_of_stopping: float | None
    verdict: str


class _Check(BaseModel, allow_inf_nan=False):
    """What armour check --json prints of one scenario, and can be compared."""

    scenario: str
    verdict: str
    threats: list[_Threat]
    requirements: list[_Limit]
    basis: dict[str, str]


@dataclass(frozen=True)
class Moved:
    """A difference from an earlier check.

    Attributes
    ----------
    scenario, threat : str
        Path of the scenario, and name of the threat; empty if it is about none.
    quantity : str
        A key of the check, such as "velocity_m_s".
    before, now : float, str or None
        Its values; None for no number.
    weaker : bool
        Whether the requirement or the threat is weaker now or missing, what the answer rests on has changed, or the
        probability of stopping is not known any more.
    """

    scenario: str
    threat: str
    quantity: str
    before: float | str | None
    now: float | str | None
    weaker: bool = False


def moved(earlier: Any, checks: Sequence[Mapping[str, Any]], file: str) -> Iterator[Moved]:
    """Yield what differs between earlier checks and the present ones, matched by the path of the scenario.

    `earlier` is the content of a file that armour check --json wrote, a check or a list of them; `checks` are those of
    now, as the same plain data.  `file` is the name of the file, for the InputError if it is no such file.
    """
    try:
        base = TypeAdapter(list[_Check]).validate_python(earlier if isinstance(earlier, list) else [earlier])
    except ValidationError:
        raise mistake(file, "", NO_BASE) from None
    before, now = ({each.scenario: each for each in found} for found in (base, map(_Check.model_validate, checks)))
    for scenario in dict.fromkeys((*before, *now)):
        old, new = before.get(scenario), now.get(scenario)
        if old is None or new is None:
            yield _presence(scenario, "", "scenario", is_new=old is None)
        else:
            yield from _moved_threats(scenario, old.threats, new.threats)
            yield from _moved_limits(scenario, old.requirements, new.requirements)
            if old.verdict != new.verdict:
                yield Moved(scenario, "", "verdict", old.verdict, new.verdict)
        if new is not None:
            bases = {} if old is None else old.basis, new.basis
            for part in sorted({*bases[0], *bases[1]}):
                if bases[0].get(part) != bases[1].get(part):
                    word, now_word = (PRESENT if part in basis else MISSING for basis in bases)
                    yield Moved(scenario, "", part, word, "changed" if now_word == word else now_word, weaker=True)


def _presence(scenario: str, threat: str, what: str, *, is_new: bool) -> Moved:
    """Return the difference that a scenario, a threat or a limit, named by `what`, is new or missing now."""
    before, now = (MISSING, PRESENT) if is_new else (PRESENT, MISSING)
    return Moved(scenario, threat, what, before, now, weaker=not is_new)


def _moved_threats(scenario: str, old: Sequence[_Threat], new: Sequence[_Threat]) -> Iterator[Moved]:
    """Yield each difference in threats; threats of one name are matched by velocity and angle, then by their order."""
    unmatched = list(new)
    exact_matches = {id(threat): _take_match(unmatched, threat, exactly=True) for threat in old}
    for threat in old:
        match = exact_matches[id(threat)] or _take_match(unmatched, threat, exactly=False)
        if match is None:
            yield _presence(scenario, threat.name, "threat", is_new=False)
            continue
        for quantity in _Threat.model_fields:
            before, now = getattr(threat, quantity), getattr(match, quantity)
            if not is_same(before, now):
                yield Moved(scenario, threat.name, quantity, before, now, _is_weaker(quantity, before, now))
    for threat in unmatched:
        yield _presence(scenario, threat.name, "threat", is_new=True)


def _take_match(threats: list[_Threat], threat: _Threat, *, exactly: bool) -> _Threat | None:
    """Remove from `threats` the first with the name and, if `exactly`, velocity and angle of `threat`; return it."""
    keys = ("name", "velocity_m_s", "obliquity_deg") if exactly else ("name",)
    for place, other in enumerate(threats):
        if all(getattr(other, key) == getattr(threat, key) for key in keys):
            return threats.pop(place)
    return None


def _is_weaker(quantity: str, before: Any, now: Any) -> bool:
    """Return whether a change of one quantity makes the threat, or what is required against it, weaker.

    Another projectile always counts as weaker, as nothing tells which of two is the stronger, and so does a probability
    that was known and is not any more.
    """
    if quantity in ("velocity_m_s", "required_margin_m_s", "required_probability"):
        return now is None or (before is not None and bool(now < before))
    if quantity == "probability_of_stopping":
        return now is None
    return quantity == "projectile" or (quantity == "obliquity_deg" and bool(now > before))


def _moved_limits(scenario: str, old: Sequence[_Limit], new: Sequence[_Limit]) -> Iterator[Moved]:
    """Yield each difference in the greatest areal density, thickness and cost allowed, and in those of the armour.

    The former are `required` and the latter `found`; a higher limit is weaker.
    """
    before, now = ({limit.quantity: limit for limit in limits} for limits in (old, new))
    for quantity in dict.fromkeys((*before, *now)):
        if quantity not in now or quantity not in before:
            yield _presence(scenario, "", f"limit of {quantity}", is_new=quantity in now)
            continue
        earlier, later = before[quantity], now[quantity]
        if not is_same(earlier.required, later.required):
            is_weaker = later.required > earlier.required
            yield Moved(scenario, "", f"limit of {quantity}", earlier.required, later.required, is_weaker)
        if not is_same(earlier.found, later.found):
            yield Moved(scenario, "", quantity, earlier.found, later.found)


def is_same(before: Any, now: Any) -> bool:
    """Return whether two values are equal; numbers may differ in their last digits."""
    if isinstance(before, int | float) and isinstance(now, int | float):
        return isclose(before, now, rel_tol=1e-6)  # machines differ in the last digits
    return bool(before == now)
