"""Designs from a catalogue against several threats: the best, those that come near, and why the others lose."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

from armour.analysis.least_thickness import Design, grid, solver_options
from armour.core.state import Outcome
from armour.errors import InputError, NoDesignError, Problem
from armour.scenario.applicability import warnings_of
from armour.scenario.loading import Scenario
from armour.scenario.parameters import BACKING, CERAMIC, VELOCITY, inputs_of, with_inputs
from armour.scenario.schema import FASTEST_M_S, BackingLayer, CeramicLayer, DesignSection, Layer, Threat
from armour.statistics.uncertainty import Estimate, check_samples, perforations, proportion, section_of
from armour.units import MM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from armour.engine.batch import SolverOptions

    Floats = NDArray[np.float64]
    Ints = NDArray[np.int64]
    Bools = NDArray[np.bool_]

# A design that meets a limit but for rounding keeps to it.
ROUNDING = 1e-12
# Decimals of what designs weigh, measure and cost: sums of equal parts in another order are equal.
DIGITS = 9
# What designs can be compared in, in words with the unit.
CRITERIA = {
    "areal_density_kg_m2": "areal density, kg/m²",
    "thickness_mm": "thickness, mm",
    "cost_per_m2": "cost per m²",
    "margin_m_s": "margin, m/s",
}
# Designs that are computed at a time.
CHUNK = 4096
# Width to which thicknesses that are free are found, mm, and values of a free backing that are tried at a time.
FREE_TOLERANCE_MM = 1e-6
FREE_BACKING_TOLERANCE_MM = 1e-3
FREE_VALUES = 41
# From where a ballistic limit is searched for, m/s.
SLOWEST_M_S = 20.0
# Samples of a design after which it is first asked whether it can still pass.
FIRST_SAMPLES = 256


@dataclass(frozen=True)
class StudyDesign:
    """A design that defeats every threat.

    Attributes
    ----------
    ceramic, backing : str
    ceramic_thickness_mm, backing_thickness_mm : float
    ceramic_density_kg_m3, backing_density_kg_m3 : float
    areal_density_kg_m2, thickness_mm, cost_per_m2 : float
        With what the section ``design`` adds.
    margins_m_s : dict of str to float
        By threat: its ballistic limit, 10,000 m/s at most, less the threat's velocity.
    governing : str
        The threat of which least of the margin it asks for is left.
    ballistic_limit_m_s : float
        Against the governing threat.
    probabilities : dict of str to Estimate
        Of perforation, by threat that bounds it.
    """

    ceramic: str
    backing: str
    ceramic_thickness_mm: float
    backing_thickness_mm: float
    ceramic_density_kg_m3: float
    backing_density_kg_m3: float
    areal_density_kg_m2: float
    thickness_mm: float
    cost_per_m2: float
    margins_m_s: dict[str, float]
    governing: str
    ballistic_limit_m_s: float
    probabilities: dict[str, Estimate]


@dataclass(frozen=True)
class Pair:
    """A ceramic and a metal, and how their best design does.

    Attributes
    ----------
    ceramic, backing : str
    best : StudyDesign or None
    excess_percent : float or None
        By how much more of what is minimised than the best of all.
    reason : str
        Why it loses.
    """

    ceramic: str
    backing: str
    best: StudyDesign | None
    excess_percent: float | None
    reason: str


@dataclass(frozen=True)
class ParetoPoint:
    """A design of a Pareto front: nothing on offer is better in one of the criteria and as good in the others."""

    ceramic: str
    backing: str
    ceramic_thickness_mm: float
    backing_thickness_mm: float
    areal_density_kg_m2: float
    thickness_mm: float
    cost_per_m2: float
    margin_m_s: float | None


@dataclass(frozen=True)
class StudyResult:
    """The answer to a design question.

    Attributes
    ----------
    minimised : str
    threats : tuple of str
    best : StudyDesign
    frontier : tuple of Design
        Of the best pair: for each backing thickness the thinnest ceramic that defeats every threat.
    frontier_governed_by : tuple of str
        For each of these the threat of which least of the margin it asks for is left.
    pairs : tuple of Pair
        The best first.
    criteria : tuple of str
        Of the Pareto front.
    pareto : tuple of Compromise
        Empty where it was not asked for.
    designs, examined : int
        On offer within the limits, and those that had to be computed.
    warnings : tuple of str
    """

    minimised: str
    threats: tuple[str, ...]
    best: StudyDesign
    frontier: tuple[Design, ...]
    frontier_governed_by: tuple[str, ...]
    pairs: tuple[Pair, ...]
    criteria: tuple[str, ...]
    pareto: tuple[ParetoPoint, ...]
    designs: int
    examined: int
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """The result as plain data."""
        return asdict(self)


class _Offer(NamedTuple):
    """A pair of materials on offer, against every threat."""

    ceramic: CeramicLayer
    backing: BackingLayer
    against: tuple[Scenario, ...]  # the pair in the scenario of each threat
    rows: "Floats"  # the core's armour of each, (threats, 13)
    density: tuple[float, float]


class _Table(NamedTuple):
    """Designs, an entry each."""

    pair: "Ints"
    ceramic_mm: "Floats"
    backing_mm: "Floats"
    areal_density_kg_m2: "Floats"
    thickness_mm: "Floats"
    cost_per_m2: "Floats"

    def at(self, where: "Ints | Bools") -> "_Table":
        """Some of them."""
        pair, *numbers = self
        return _Table(pair[where], *(column[where] for column in numbers))


def asks_for_study(scenario: Scenario) -> bool:
    """Whether the scenario has threats or a catalogue of its own."""
    return bool(scenario.threat) or scenario.design is not None


def study(scenario: Scenario) -> StudyResult:
    """Find the best design of the scenario's catalogue that defeats all of its threats.

    Designs of given thicknesses are examined in the order of what is minimised until one defeats every threat: those
    before it were examined, those after it cannot win.  Nothing is taken for monotonic.  Where a thickness is free, the
    least of it that the other layer needs is bisected.  Under a bound on the probability of perforation only designs
    are sampled that defeat the threats with the inputs as they stand.

    Raises
    ------
    InputError
        If something is missing in the scenario.
    NoDesignError
        If no design on offer defeats every threat.
    """
    section = scenario.design or DesignSection()
    threats = threats_of(scenario)
    offers = [
        _offer(scenario, ceramic, backing, threats)
        for ceramic in ceramics_of(scenario)
        for backing in backings_of(scenario)
    ]
    if any(threat.probability_of_perforation is not None for threat in threats):
        _check_distributions(offers, threats)
    table = _table(offers, section, threats)
    order = getattr(table, section.minimise).argsort(kind="stable")
    table = table.at(order)
    search = _Search(offers, section, threats, table)
    best = search.first(range(len(table.pair)))
    if best is None:
        raise NoDesignError(_no_design(search))
    return _result(search, best)


def threats_of(scenario: Scenario) -> tuple[Threat, ...]:
    """The scenario's threats; where it lists none, its impact."""
    own = Threat(projectile=scenario.impact.projectile, velocity_m_s=scenario.impact.velocity_m_s)
    threats = tuple(scenario.threat) or (own,)
    titles = [threat.title for threat in threats]
    problems = [
        Problem(scenario.file, f"threat[{i}].name", f'must tell the threat from the others, found "{title}" twice')
        for i, title in enumerate(titles)
        if title in titles[:i]
    ]
    if any(threat.probability_of_perforation is not None for threat in threats):
        layers = [*scenario.design.ceramic, *scenario.design.backing] if scenario.design is not None else []
        if any(layer.free for layer in layers):
            message = "must have a step for each thickness_mm where a threat has probability_of_perforation"
            problems.append(Problem(scenario.file, "design", message))
    if problems:
        raise InputError(problems)
    return threats


def _check_distributions(offers: Sequence[_Offer], threats: Sequence[Threat]) -> None:
    """Make sure that the distributions follow designs, materials and threats, and that the samples suffice.

    Raises
    ------
    InputError
        If there are none, one has a place of its own where the values that it must be about differ, or the samples are
        too few to show so small a probability.
    """
    scenarios = [scenario for offer in offers for scenario in offer.against]
    section, file = section_of(scenarios[0]), scenarios[0].file
    owns = [inputs_of(scenario) for scenario in scenarios]
    problems = []
    for name, found in section.inputs().items():
        values = {own.get(name) for own in owns}
        if found.placed and (len(values) > 1 or name in (VELOCITY, CERAMIC, BACKING)):
            message = "must be about the value of each design or threat: normal or lognormal, without mean, min and max"
            problems.append(Problem(file, f"uncertainty.{name}", message))
    bound = min(threat.probability_of_perforation or inf for threat in threats)
    if proportion(0, section.samples).high > bound:
        message = f"must be more to show a probability of perforation of {bound:g}, found {section.samples}"
        problems.append(Problem(file, "uncertainty.samples", message))
    if problems:
        raise InputError(problems)


def ceramics_of(scenario: Scenario) -> list[CeramicLayer]:
    """Ceramics on offer; where the section ``design`` has none, the scenario's own in the range of ``optimise``."""
    if scenario.design is not None and scenario.design.ceramic:
        return scenario.design.ceramic
    section = grid(scenario).ceramic_thickness_mm
    if scenario.armour.ceramic is None:
        return [CeramicLayer.model_construct(material="", thickness_mm=[0.0])]
    return [CeramicLayer(material=scenario.armour.ceramic, thickness_mm=section)]


def backings_of(scenario: Scenario) -> list[BackingLayer]:
    """Metals on offer; where the section ``design`` has none, the scenario's own in the range of ``optimise``."""
    if scenario.design is not None and scenario.design.backing:
        return scenario.design.backing
    return [BackingLayer(material=scenario.armour.backing, thickness_mm=grid(scenario).backing_thickness_mm)]


def _offer(scenario: Scenario, ceramic: CeramicLayer, backing: BackingLayer, threats: Sequence[Threat]) -> _Offer:
    from armour.engine import batch

    changes: dict[str, object] = {"armour.backing": backing.material}
    if ceramic.material:
        changes["armour.ceramic"] = ceramic.material
    densities = {"ceramic.density_kg_m3": ceramic.density_kg_m3, "backing.density_kg_m3": backing.density_kg_m3}
    given = {name: value for name, value in densities.items() if value is not None}
    against = []
    for threat in threats:
        made = scenario.replaced({**changes, "impact.projectile": threat.projectile, VELOCITY: threat.velocity_m_s})
        against.append(with_inputs(made, given) if given else made)
    armours = [made.core_armour() for made in against]
    return _Offer(ceramic, backing, tuple(against), batch.packed(armours), (armours[0].rho_c, armours[0].rho_B))


def _table(offers: Sequence[_Offer], section: DesignSection, threats: Sequence[Threat]) -> _Table:
    """Designs on offer that keep to the limits; of a free thickness what the other layer needs."""
    import numpy as np

    parts = []
    for index, offer in enumerate(offers):
        if offer.ceramic.free or offer.backing.free:
            ceramic, backing = _free_designs(offer, section, threats)
        else:
            ceramic, backing = (
                values.ravel()
                for values in np.meshgrid(offer.ceramic.thicknesses(), offer.backing.thicknesses(), indexing="ij")
            )
        parts.append(_designs(offer, index, section, ceramic, backing))
    table = _Table(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    return table.at(_excess(table, section) <= 0.0)


def _excess(table: _Table, section: DesignSection) -> "Floats":
    """By which part each design exceeds the limit that it exceeds most; 0 where it keeps to all."""
    import numpy as np

    excess = np.zeros(len(table.pair))
    for values, most in (
        (table.thickness_mm, section.thickness_max_mm),
        (table.areal_density_kg_m2, section.areal_density_max_kg_m2),
        (table.cost_per_m2, section.cost_max_per_m2),
    ):
        if most is not None:
            excess = np.maximum(excess, values / most - 1.0 - ROUNDING)
    return excess


def _designs(offer: _Offer, index: int, section: DesignSection, ceramic: "Floats", backing: "Floats") -> _Table:
    """Designs of a pair with what they weigh, measure and cost."""
    import numpy as np

    masses = offer.density[0] * ceramic * MM, offer.density[1] * backing * MM
    cost = np.full(len(ceramic), section.added_cost_per_m2)
    for layer, mass, thickness in ((offer.ceramic, masses[0], ceramic), (offer.backing, masses[1], backing)):
        cost += layer.cost_per_kg * mass + np.where(thickness > 0.0, layer.cost_per_m2, 0.0)
    return _Table(
        np.full(len(ceramic), index),
        ceramic,
        backing,
        np.round(masses[0] + masses[1] + section.added_areal_density_kg_m2, DIGITS),
        np.round(ceramic + backing + section.added_thickness_mm, DIGITS),
        np.round(cost, DIGITS),
    )


def _free_designs(offer: _Offer, section: DesignSection, threats: Sequence[Threat]) -> tuple["Floats", "Floats"]:
    """Designs of a pair of which a layer is free: the least of it that each value of the other needs.

    Where both are free the backings are tried ever closer together round the best.
    """
    import numpy as np

    if not offer.backing.free:
        backing = np.array(offer.backing.thicknesses())
        return _kept(_least(offer, threats, "Hc0", backing), backing)
    if not offer.ceramic.free:
        ceramic = np.array(offer.ceramic.thicknesses())
        return _kept(_least(offer, threats, "Hb", ceramic), ceramic)[::-1]
    low, high = offer.backing.thicknesses()
    found: list[tuple[Floats, Floats]] = []
    start, end = low, high
    while True:
        backing = np.linspace(start, end, FREE_VALUES)
        ceramic = _least(offer, threats, "Hc0", backing)
        found.append((ceramic, backing))
        designs = _designs(offer, 0, section, ceramic, backing)
        excess = np.where(np.isnan(ceramic), inf, _excess(designs, section))
        # As long as none keeps to the limits, towards where they are exceeded least.
        kept = excess <= 0.0
        values = np.where(kept, getattr(designs, section.minimise), inf) if kept.any() else excess
        step = (end - start) / (FREE_VALUES - 1)
        if step <= FREE_BACKING_TOLERANCE_MM or not np.isfinite(values).any():
            return _kept(*(np.concatenate(columns) for columns in zip(*found, strict=True)))
        centre = float(backing[values.argmin()])
        start, end = max(low, centre - 1.5 * step), min(high, centre + 1.5 * step)


def _kept(least: "Floats", other: "Floats") -> tuple["Floats", "Floats"]:
    """Where the free layer has a value that is enough."""
    import numpy as np

    there = ~np.isnan(least)
    return least[there], other[there]


def _least(offer: _Offer, threats: Sequence[Threat], layer: str, other: "Floats") -> "Floats":
    """The least of a free layer, mm, that each thickness of the other needs; NaN where its most is not enough."""
    import numpy as np

    free: Layer = offer.ceramic if layer == "Hc0" else offer.backing
    low, high = (np.full(len(other), end) for end in free.thicknesses())

    told = solver_options(offer.against[0])

    def enough(values: "Floats") -> "Bools":
        ceramic, backing = (values, other) if layer == "Hc0" else (other, values)
        all_of_them = np.ones(len(other), dtype=bool)
        for row, threat in zip(offer.rows, threats, strict=True):
            all_of_them &= _defeated(row, threat, told, ceramic, backing)
        return all_of_them

    at_most, at_least = enough(high), enough(low)
    high = np.where(at_least, low, high)
    while (high - low).max() > FREE_TOLERANCE_MM:
        middle = 0.5 * (low + high)
        good = enough(middle)
        low, high = np.where(good, low, middle), np.where(good, middle, high)
    return np.where(at_most, high, np.nan)


def _with_thicknesses(rows: "Floats", ceramic_mm: "Floats", backing_mm: "Floats") -> "Floats":
    """A row for each pair of thicknesses, of one armour or one each."""
    import numpy as np

    from armour.engine import batch

    made = np.broadcast_to(rows, (len(ceramic_mm), rows.shape[-1])).copy()
    a = batch.fields(made)
    a.Hc0[:], a.Hb[:] = ceramic_mm * MM, backing_mm * MM
    return made


def _defeated(
    rows: "Floats", threat: Threat, told: "SolverOptions", ceramic_mm: "Floats", backing_mm: "Floats"
) -> "Bools":
    """Whether armours of these thicknesses defeat a threat with its margin."""
    import numpy as np

    from armour.engine import batch

    velocities = np.full(len(ceramic_mm), threat.required_m_s)
    made = _with_thicknesses(rows, ceramic_mm, backing_mm)
    found: Bools = batch.impacts(made, velocities, told).outcome == Outcome.DEFEATED
    return found


class _Search:
    """Which designs of a table, in the order of what is minimised, defeat every threat; what is found is kept."""

    def __init__(
        self, offers: Sequence[_Offer], section: DesignSection, threats: Sequence[Threat], table: _Table
    ) -> None:
        import numpy as np

        from armour.scenario.sampling import points_of

        self.offers, self.section, self.threats, self.table = offers, section, threats, table
        self.rows = np.array([offer.rows for offer in offers])
        self.told = solver_options(offers[0].against[0])
        self.known = np.zeros(len(table.pair), dtype=bool)
        self.good = np.zeros(len(table.pair), dtype=bool)
        self.values: Floats = getattr(table, section.minimise)
        self.sampled: dict[int, dict[str, Estimate] | None] = {}
        self.bounded = any(threat.probability_of_perforation is not None for threat in threats)
        self.points = points_of(section_of(offers[0].against[0])) if self.bounded else np.empty((0, 0))

    def examine(self, where: "Ints") -> None:
        """Find out which designs defeat every threat with the inputs as they stand."""
        where = where[~self.known[where]]
        alive = where
        for i, threat in enumerate(self.threats):
            if len(alive):
                table = self.table.at(alive)
                good = _defeated(self.rows[table.pair, i], threat, self.told, table.ceramic_mm, table.backing_mm)
                alive = alive[good]
        self.known[where] = True
        self.good[alive] = True

    def first(self, where: "Sequence[int] | Ints") -> int | None:
        """The first of the designs that passes."""
        return next(self.passing(where), None)

    def passing(self, where: "Sequence[int] | Ints") -> Iterator[int]:
        """Designs that pass, in their order."""
        import numpy as np

        places = np.asarray(where, dtype=np.int64)
        for start in range(0, len(places), CHUNK):
            chunk = places[start : start + CHUNK]
            self.examine(chunk)
            for place in chunk[self.good[chunk]].tolist():
                if not self.bounded or self.probabilities(place) is not None:
                    yield place

    def probabilities(self, place: int) -> dict[str, Estimate] | None:
        """Probabilities of perforation of a design, by threat that bounds it; None where one is too high."""
        if place not in self.sampled:
            self.sampled[place] = self._sampled(place)
        return self.sampled[place]

    def _sampled(self, place: int) -> dict[str, Estimate] | None:
        found = {}
        for i, threat in enumerate(self.threats):
            if threat.probability_of_perforation is not None:
                offer = self.offers[self.table.pair[place]]
                estimate = reliability(
                    offer.against[i],
                    self.points,
                    float(self.table.ceramic_mm[place]),
                    float(self.table.backing_mm[place]),
                    threat.probability_of_perforation,
                )
                if estimate is None:
                    return None
                found[threat.title] = estimate
        return found


def reliability(
    scenario: Scenario, points: "Floats", ceramic_mm: float, backing_mm: float, bound: float
) -> Estimate | None:
    """Probability of perforation of a design where the upper end of its interval is within a bound; else None.

    The samples are taken in parts, and no more of them than it takes to see that the bound is passed.

    Parameters
    ----------
    scenario : Scenario
        The design's materials and the threat, with distributions.
    points : array, (samples, inputs)
        Of the unit cube, see `armour.scenario.sampling.points_of`.
    ceramic_mm, backing_mm, bound : float

    Raises
    ------
    InputError
        If a distribution reaches values that are not allowed.
    """
    import numpy as np

    from armour.scenario.sampling import columns_of

    section = section_of(scenario)
    own = {**inputs_of(scenario), CERAMIC: ceramic_mm, BACKING: backing_mm}
    hits, start, end = 0, 0, FIRST_SAMPLES
    while start < len(points):
        columns = columns_of(section, own, points[start:end])
        if any(not np.isfinite(values).all() or values.min() <= 0.0 for values in columns.values()):
            check_samples(scenario, columns)
        for name in (CERAMIC, BACKING):
            columns.setdefault(name, np.full(len(points[start:end]), own[name]))
        hits += int(perforations(scenario, columns).sum())
        estimate = proportion(hits, len(points))
        if estimate.high > bound:
            return None
        start, end = end, 2 * end
    return estimate


def _result(search: _Search, best: int) -> StudyResult:
    """The answer, with the pairs that lose and why."""
    import numpy as np

    section, table, offers = search.section, search.table, search.offers
    least = float(search.values[best])
    heaviest = least * (1.0 + section.runners_up_percent / 100.0)
    firsts: dict[int, int] = {}
    for pair in range(len(offers)):
        own = np.flatnonzero(table.pair == pair)
        # Sampling is dear: under a bound on a probability only what can be a runner-up is asked.
        place = search.first(own[search.values[own] <= heaviest] if search.bounded else own)
        if place is not None:
            firsts[pair] = place
    winner = int(table.pair[best])
    pairs = [_pair(search, pair, firsts.get(pair), least) for pair in range(len(offers))]
    pairs.sort(key=lambda pair: inf if pair.excess_percent is None else pair.excess_percent)
    chosen = _made(search, best)
    along = _frontier(search, winner)
    pareto = _pareto(search) if section.pareto is not None else ()
    governing = [threat.title for threat in search.threats].index(chosen.governing)
    thicknesses = {CERAMIC: chosen.ceramic_thickness_mm, BACKING: chosen.backing_thickness_mm}
    governed = offers[winner].against[governing].replaced(thicknesses)
    return StudyResult(
        minimised=section.minimise,
        threats=tuple(threat.title for threat in search.threats),
        best=chosen,
        frontier=tuple(_design(search.table, place) for place in along.tolist()),
        frontier_governed_by=tuple(search.threats[i].title for i in _governing(search, along)[1].tolist()),
        pairs=tuple(pairs),
        criteria=tuple(section.pareto or ()),
        pareto=pareto,
        designs=len(table.pair),
        examined=int(search.known.sum()),
        warnings=warnings_of(governed, governed.impact.velocity_m_s),
    )


def _pair(search: _Search, pair: int, place: int | None, least: float) -> Pair:
    """A pair with its best design, or why it has none."""
    offer = search.offers[pair]
    names = offer.ceramic.material, offer.backing.material
    if place is not None:
        value = float(search.values[place])
        word = {"areal_density_kg_m2": "heavier", "thickness_mm": "thicker", "cost_per_m2": "dearer"}
        if least <= 0.0 < value:
            return Pair(*names, _made(search, place), None, word[search.section.minimise])
        excess = 100.0 * (value / least - 1.0) if least > 0.0 else 0.0
        near = "runner-up: " if excess <= search.section.runners_up_percent else ""
        reason = "" if excess <= 0.0 else f"{near}{excess:.1f} % {word[search.section.minimise]}"
        return Pair(*names, _made(search, place), excess, reason)
    own = search.table.at(search.table.pair == pair)
    if not len(own.pair):
        return Pair(*names, None, None, "nothing on offer keeps to the limits")
    if search.good[search.table.pair == pair].any():
        return Pair(*names, None, None, f"none within {search.section.runners_up_percent:g} % of the best")
    lost = [
        threat.title
        for row, threat in zip(offer.rows, search.threats, strict=True)
        if not _defeated(row, threat, search.told, own.ceramic_mm, own.backing_mm).any()
    ]
    return Pair(*names, None, None, f"nothing on offer defeats {' or '.join(lost) if lost else 'all threats at once'}")


def _margins(search: _Search, where: "Ints") -> "Floats":
    """Ballistic limits, as far as the program's velocities reach, less the threats' velocities; (designs, threats)."""
    import numpy as np

    from armour.engine import batch

    table = search.table.at(where)
    section = search.offers[0].against[0].ballistic_limit
    low, high = min(section.velocity_min_m_s, SLOWEST_M_S), FASTEST_M_S
    found = np.empty((len(where), len(search.threats)))
    for i, threat in enumerate(search.threats):
        rows = _with_thicknesses(search.rows[table.pair, i], table.ceramic_mm, table.backing_mm)
        places = batch.ballistic_limits(rows, low, high, section.tolerance_m_s, search.told)
        found[:, i] = places.within(low, high) - threat.velocity_m_s
    return found


def _governing(search: _Search, where: "Ints") -> tuple["Floats", "Ints"]:
    """Margins of designs, and the threats of which least of the margin they ask for is left."""
    import numpy as np

    margins = _margins(search, where)
    asked = np.array([threat.margin_m_s for threat in search.threats])
    return margins, (margins - asked).argmin(axis=1)


def _made(search: _Search, place: int) -> StudyDesign:
    """A design of the table with its margins."""
    import numpy as np

    offer = search.offers[search.table.pair[place]]
    all_margins, least_left = _governing(search, np.array([place]))
    margins, governing = all_margins[0], int(least_left[0])
    return StudyDesign(
        ceramic=offer.ceramic.material,
        backing=offer.backing.material,
        ceramic_thickness_mm=float(search.table.ceramic_mm[place]),
        backing_thickness_mm=float(search.table.backing_mm[place]),
        ceramic_density_kg_m3=offer.density[0],
        backing_density_kg_m3=offer.density[1],
        areal_density_kg_m2=float(search.table.areal_density_kg_m2[place]),
        thickness_mm=float(search.table.thickness_mm[place]),
        cost_per_m2=float(search.table.cost_per_m2[place]),
        margins_m_s={threat.title: float(margin) for threat, margin in zip(search.threats, margins, strict=True)},
        governing=search.threats[governing].title,
        ballistic_limit_m_s=float(margins[governing]) + search.threats[governing].velocity_m_s,
        probabilities=search.probabilities(place) or {} if search.bounded else {},
    )


def _frontier(search: _Search, pair: int) -> "Ints":
    """For each backing of a pair the thinnest ceramic that defeats every threat with the inputs as they stand."""
    import numpy as np

    own = np.flatnonzero(search.table.pair == pair)
    search.examine(own)
    good = own[search.good[own]]
    order = good[np.lexsort((search.table.ceramic_mm[good], search.table.backing_mm[good]))]
    _, first = np.unique(search.table.backing_mm[order], return_index=True)
    found: Ints = order[first]
    return found


def _design(table: _Table, place: int) -> Design:
    return Design(
        float(table.ceramic_mm[place]), float(table.backing_mm[place]), float(table.areal_density_kg_m2[place])
    )


def _pareto(search: _Search) -> tuple[ParetoPoint, ...]:
    """Designs that no other betters in one criterion without being worse in another."""
    import numpy as np

    assert search.section.pareto is not None
    passing = np.array(list(search.passing(range(len(search.table.pair)))), dtype=np.int64)
    table = search.table.at(passing)
    margins = _margins(search, passing).min(axis=1) if "margin_m_s" in search.section.pareto else None
    costs = np.column_stack(
        [
            -margins if name == "margin_m_s" and margins is not None else getattr(table, name)
            for name in search.section.pareto
        ]
    )
    front = undominated(costs)
    return tuple(
        ParetoPoint(
            ceramic=search.offers[table.pair[i]].ceramic.material,
            backing=search.offers[table.pair[i]].backing.material,
            ceramic_thickness_mm=float(table.ceramic_mm[i]),
            backing_thickness_mm=float(table.backing_mm[i]),
            areal_density_kg_m2=float(table.areal_density_kg_m2[i]),
            thickness_mm=float(table.thickness_mm[i]),
            cost_per_m2=float(table.cost_per_m2[i]),
            margin_m_s=None if margins is None else float(margins[i]),
        )
        for i in front.tolist()
    )


def undominated(costs: "Floats") -> "Ints":
    """Rows that no other row is at most equal to in every column and less than in one; equal rows once."""
    import numpy as np

    order = np.lexsort(costs.T[::-1])
    left = order
    front = []
    while len(left):
        front.append(int(left[0]))
        left = left[(costs[left] < costs[left[0]]).any(axis=1)]
    return np.array(front, dtype=np.int64)


def _no_design(search: _Search) -> str:
    """What to say where nothing on offer passes."""
    if not len(search.table.pair):
        return "no design: nothing on offer keeps to the limits of the section design"
    lost = [pair.reason for pair in (_pair(search, i, None, 1.0) for i in range(len(search.offers)))]
    if search.bounded and search.good.any():
        return "no design: nothing on offer keeps the probability of perforation within the bound of every threat"
    return f"no design: {'; '.join(dict.fromkeys(lost))}; offer more thickness in the section design or optimise"
