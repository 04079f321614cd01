"""Compare the ballistic limits of the engine with those by steps 100 times shorter.

The armours are of the paper's materials, bare plates, and up to a factor of two outside the ranges of the tests.  The
reference has steps 100 times shorter, everywhere.  A limit is within a distance of it if, by these steps, an impact
faster than the limit by the distance perforates and one slower by it is stopped.

    python -m tools.campaigns accuracy
"""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
from numpy.typing import NDArray

from armour.core import equations
from armour.core.search import RunSettings
from armour.core.state import Outcome, Parameters
from armour.engine import batch
from armour.evidence.tests import UNUSUAL_FACTOR
from tests.helpers.runs import random_designs
from tools.campaigns.unusual import rows_within
from tools.campaigns.verdict import asked, verdict

TOLERANCE = 1e-5  # m/s
LOW, HIGH = 20.0, 4000.0  # m/s
PART = 1.0 / 100.0
# About the length of a usual step, in times in which the penetrator crosses its diameter, or the armour.
STEP = 0.1
MAX_STEPS = 50_000_000
# Errors that are told apart, m/s.
BOUNDS = np.concatenate([np.arange(1, 100) * 1e-4, np.geomspace(1e-2, 1e2, 41)])
# What the errors are stated to be, m/s.
CLAIMED = {"the paper's materials": 3e-3, "bare plates": 3e-3, "nearly unusual": 4e-3, "the same, interface": 4e-3}


def perforates(rows: batch.Floats, velocities: batch.Floats) -> NDArray[np.bool_]:
    """Return whether impacts perforate by given steps, shorter than the usual ones by about `PART`."""
    perforated = np.empty(len(rows), np.bool_)
    for i, row in enumerate(rows.tolist()):
        p = Parameters(*row)
        step = PART * STEP * min(p.D0, p.Hc0 + p.Hb) / float(velocities[i])
        settings = RunSettings(1.0, step, MAX_STEPS)
        found = batch.impacts(rows[i : i + 1], velocities[i], settings, threads=1)
        perforated[i] = found.outcome[0] == Outcome.PERFORATED
    return perforated


def errors(rows: batch.Floats, limits: batch.Floats, pool: ProcessPoolExecutor) -> batch.Floats:
    """Return the least of `BOUNDS` within which each limit is, m/s; infinite if it is within none."""
    bounds = np.full(len(rows), np.inf)
    for bound in BOUNDS:
        parts = np.array_split(np.flatnonzero(np.isinf(bounds)), batch.available_cores())
        above = pool.map(perforates, [rows[part] for part in parts], [limits[part] + bound for part in parts])
        below = pool.map(perforates, [rows[part] for part in parts], [limits[part] - bound for part in parts])
        for part, faster, slower in zip(parts, above, below, strict=True):
            bounds[part[faster & ~slower]] = bound
    return bounds


def main() -> int:
    """Print the errors."""
    options = asked(__doc__, designs=1_000, nearly=1_000)
    nearly = rows_within(UNUSUAL_FACTOR, options.nearly)
    places = {name: Parameters._fields.index(name) for name in ("Hc0", "drive_law")}

    def changed(name: str, value: float) -> batch.Floats:
        rows = nearly.copy()
        rows[:, places[name]] = value
        return rows

    populations = {
        "the paper's materials": batch.packed(random_designs(options.designs)),
        "bare plates": changed("Hc0", 0.0),
        "nearly unusual": changed("drive_law", equations.STRENGTH),
        "the same, interface": changed("drive_law", equations.INTERFACE),
    }
    texts, over = [], 0
    with ProcessPoolExecutor(batch.available_cores(), get_context("spawn")) as pool:
        for name, rows in populations.items():
            found = batch.ballistic_limits(rows, LOW, HIGH, TOLERANCE)
            bounded = np.isfinite(found.stopped) & np.isfinite(found.perforated)
            known = errors(rows[bounded], found.perforated[bounded], pool)
            texts.append(f"{name} {known.max():.4f} ({len(known):,} limits)")
            over += int((known > 1.0001 * CLAIMED[name]).sum())
    return verdict(f"greatest error, m/s: {', '.join(texts)}", right=not over)
