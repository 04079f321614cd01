"""Error of the ballistic limits that the engine finds, over 10,000 random ceramic armours and 1,000 bare plates.

The reference has time steps 50 times shorter. A limit is within a distance of it if, by these steps, an impact faster
than the limit by the distance perforates and one slower by it is defeated. Run it by

    python -m campaigns.accuracy
"""

import argparse

import numpy as np

from armour.core.state import Outcome, Parameters
from armour.core.stepping import default_time_step
from armour.engine import batch
from tests.helpers.cases import armour
from tests.helpers.runs import random_designs

TOLERANCE = 2e-4  # m/s
LOW, HIGH = 20.0, 4000.0  # m/s
PART = 1.0 / 200.0
CLAIMED = 1e-3  # m/s


def bare_plates(count: int) -> list[Parameters]:
    """Return random plates without a ceramic against both rounds of the paper."""
    rng = np.random.default_rng(7)
    plates = []
    for _ in range(count):
        projectile, diameter_mm = [("7.62 mm AP", 6.5), ("25 mm APDS", 14.25)][rng.integers(2)]
        metal = str(rng.choice(["6061-T6", "7075-T6", "5083-H3"]))
        plates.append(armour(projectile, None, metal, 0.0, diameter_mm * float(rng.uniform(0.2, 5.0))))
    return plates


def perforates(row: batch.Floats, velocity: float, step: float) -> bool:
    """Return whether an impact perforates by a time step, s."""
    options = batch.SolverOptions(time_step=step, max_steps=5_000_000, threads=1)
    return bool(batch.impacts(row[None], np.array([velocity]), options).outcome[0] == Outcome.PERFORATED)


def errors(designs: list[Parameters]) -> batch.Floats:
    """Return upper bounds on the errors of the limits of designs, m/s, in steps of 0.0001 m/s; NaN without a limit."""
    rows = batch.packed(designs)
    found = batch.ballistic_limits(rows, LOW, HIGH, TOLERANCE)
    bounds = np.full(len(designs), np.nan)
    for i in np.flatnonzero(found.bounded):
        limit = float(found.perforated[i])
        step = PART * default_time_step(designs[i], limit)
        for bound in np.arange(1e-4, 1.0, 1e-4):
            if perforates(rows[i], limit + bound, step) and not perforates(rows[i], limit - bound, step):
                bounds[i] = bound
                break
    return bounds


def main() -> None:
    """Print the errors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=10_000)
    parser.add_argument("--plates", type=int, default=1_000)
    asked = parser.parse_args()
    for name, designs in (
        ("random ceramic armours", list(random_designs(asked.designs))),
        ("bare plates", bare_plates(asked.plates)),
    ):
        found = errors(designs)
        known = found[np.isfinite(found)]
        shares = ", ".join(f"{q:g} %: {np.percentile(known, q):.4f}" for q in (50, 99, 99.9, 100))
        print(f"{name}: {len(known)} limits; error within, m/s: {shares}; above {CLAIMED}: {(known > CLAIMED).sum()}")


if __name__ == "__main__":
    main()
