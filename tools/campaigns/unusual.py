"""Compare ballistic limits and least thicknesses of unusual armours with dense scans by separate impacts.

Projectile and materials have values spread over decades. A limit is right if it lies at the lowest change of the
outcome that 1,025 velocities see, 1 to 10,000 m/s, or if a lower one is found that the impacts at both ends of its
bracket confirm. Designs inside of what the model was compared with, and up to a factor of two outside, are compared in
the same way. A least ceramic thickness is compared with a scan that is four times as dense.

    python -m tools.campaigns unusual
"""

import numpy as np

from armour.analysis.variants import Bools, Floats, Variants, ballistic_limits
from armour.core.search import DENSE_SCAN_POINTS, scan
from armour.core.state import Outcome, Parameters
from armour.engine import batch
from armour.evidence.tests import UNUSUAL_FACTOR, armours_of, is_unusual, shipped_evidence
from armour.scenario.scenario import Scenario
from armour.scenario.schema import DRIVE_LAWS, SHEAR_LAWS
from tests.helpers.exotic import WIDE, random_wide_designs
from tools.campaigns.verdict import asked, verdict

LOW, HIGH = WIDE.values()  # m/s
TOLERANCE = 0.01  # m/s
THICKNESSES = {"min": 0.5, "max": 60.0, "step": 1.0}  # mm
TIMES_DENSER = 4
# Designs whose impacts are computed at a time.
PART = 100
# Greatest share of limits that may be too high, of which only an impact between scanned velocities would tell.
MOST = 1e-3


def unusual_designs(count: int, seed: int) -> Variants:
    """Return unusual designs with values spread over decades, and impact velocities of 100 to 3,000 m/s."""
    rng = np.random.default_rng(seed)
    grid = {"optimise": {"ceramic_thickness_mm": THICKNESSES, "backing_thickness_mm": THICKNESSES}}
    found = [design.replaced(grid) for design in random_wide_designs(2 * count, seed)]
    rows = batch.packed([design.core_armour() for design in found])
    rows = rows[is_unusual(batch.fields(rows))][:count]
    velocities = np.exp(rng.uniform(np.log(100.0), np.log(3000.0), count))
    return variants(rows, velocities, found[0])


def variants(rows: Floats, velocities: Floats, scenario: Scenario) -> Variants:
    """Return armours at normal incidence as variants of a scenario."""
    count, materials = len(rows), tuple(armours_of(scenario).materials)
    return Variants(rows, velocities, np.ones(count), np.zeros(count, dtype=np.int64), scenario, materials)


def covered() -> dict[str, tuple[float, float]]:
    """Return the ranges over all armours with a ceramic that the model was compared with, by quantity."""
    found: dict[str, tuple[float, float]] = {}
    for evidence in shipped_evidence():
        for limits in evidence.compared if evidence.ceramic else ():
            low, high = found.get(limits.name, (np.inf, -np.inf))
            found[limits.name] = min(low, limits.low), max(high, limits.high)
    return found


def rows_within(factor: float, count: int) -> Floats:
    """Return parameters of designs with every quantity up to a factor outside of what the model was compared with."""
    rng = np.random.default_rng(11)
    of = {
        name: np.exp(rng.uniform(np.log(low / factor), np.log(high * factor), count))
        for name, (low, high) in covered().items()
    }
    D0, strength = 6.5e-3, of["backing_strength_GPa"] * 1e9
    zero = np.zeros(count)
    columns = {
        "L0": of["rod_length_ratio"] * D0,
        "D0": zero + D0,
        "rho_p": of["rod_density_kg_m3"],
        "Yp": of["rod_strength_GPa"] * 1e9,
        "Hc0": of["ceramic_thickness_ratio"] * D0,
        "rho_c": of["ceramic_density_kg_m3"],
        "Ec": of["ceramic_modulus_GPa"] * 1e9,
        "Yc0": of["ceramic_strength_GPa"] * 1e9,
        "Hb": of["backing_thickness_ratio"] * D0,
        "rho_B": of["backing_density_kg_m3"],
        "YB": strength,
        "tau": strength * of["backing_shear_ratio"],
        "shear_law": rng.integers(0, len(SHEAR_LAWS), count),
        "drive_law": rng.integers(0, len(DRIVE_LAWS), count),
    }
    return np.column_stack([columns.get(name, zero) for name in Parameters._fields])


def outcomes(designs: Variants, velocities: Floats) -> Bools:
    """Return whether each design is perforated at each velocity, (n, velocities)."""
    count = len(velocities)
    # The engine's own limit of steps, as a long rod at 2 m/s on a thin plate needs over 20,000.
    found = batch.impacts(np.repeat(designs.parameters, count, axis=0), np.tile(velocities, len(designs.velocities)))
    return (found.outcome == Outcome.PERFORATED).reshape(-1, count)


def compare_limits(name: str, designs: Variants) -> tuple[int, str]:
    """Return how many limits are above the lowest change that a scan by usual impacts sees, and words on them."""
    velocities = np.array(scan(LOW, HIGH, DENSE_SCAN_POINTS))
    parts = np.array_split(np.arange(len(designs.velocities)), -(-len(designs.velocities) // PART))
    beyond = np.concatenate([outcomes(designs.at(part), velocities) for part in parts])
    first = beyond.argmax(axis=1)
    low = np.where(beyond.any(axis=1), velocities[np.maximum(first - 1, 0)], np.inf)
    high = np.where(beyond.any(axis=1), velocities[first], np.inf)
    limits = ballistic_limits(designs, (LOW, HIGH), tolerance=TOLERANCE)
    stopped = limits - TOLERANCE
    # A bracket may contain the perforated end of the scan's.
    within = (limits >= low) & (stopped < high)
    same = within | beyond[:, 0] & np.isneginf(limits) | ~beyond.any(axis=1) & np.isposinf(limits)
    lower = np.flatnonzero(~same & (limits < low))
    ends = [designs.at(lower)._replace(velocities=end[lower]) for end in (stopped, limits)]
    confirmed = int((~ends[0].perforated() & ends[1].perforated()).sum()) if len(lower) else 0
    wrong = int((~same).sum()) - confirmed
    return wrong, f"{wrong} of {len(low):,} {name}"


def compare_thicknesses(designs: Variants) -> int:
    """Return how many least ceramic thicknesses differ from the lowest change that a denser scan sees."""
    points = TIMES_DENSER * (DENSE_SCAN_POINTS - 1) + 1
    values = np.linspace(THICKNESSES["min"], THICKNESSES["max"], points)
    same = 0
    for i in range(len(designs.velocities)):
        least = designs.at(np.array([i])).least_thicknesses("ceramic").mm[0]
        stops = ~designs.at(np.full(points, i)).with_thicknesses(ceramic_mm=values).perforated()
        first = int(stops.argmax())
        same += bool(values[max(first - 1, 0)] <= least <= values[first] if stops.any() else np.isnan(least))
    return len(designs.velocities) - same


def main() -> int:
    """Print the comparison."""
    options = asked(__doc__, designs=2_000, nearly=10_000, thicknesses=500)
    unusual = unusual_designs(options.designs, seed=24)
    nearly_rows, usual_rows = (rows_within(factor, options.nearly) for factor in (UNUSUAL_FACTOR, 1.0))
    wrong, told = compare_limits("unusual armours", unusual)
    nearly, told_nearly = compare_limits(
        "nearly unusual ones", variants(nearly_rows, nearly_rows[:, 0], unusual.scenario)
    )
    usual, told_usual = compare_limits("within the ranges", variants(usual_rows, usual_rows[:, 0], unusual.scenario))
    thicknesses = compare_thicknesses(unusual.at(slice(options.thicknesses)))
    return verdict(
        f"limits too high: {told}, {told_nearly}, {told_usual}; "
        f"least thicknesses that differ: {thicknesses} of {options.thicknesses:,}",
        right=not wrong and not usual and not thicknesses and nearly <= MOST * options.nearly,
    )
