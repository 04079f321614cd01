"""Compare rules for plates at an angle on the oblique tests of the shipped table, left out alloy by alloy.

    python -m tools.campaigns.obliquity

prints the table of docs/readings.md.  "t/cos" is what the program computes; "t/cos^n" has an exponent that is fitted to
the other alloys; "normal component" has the limit at normal incidence over the cosine.
"""

import csv
import sys
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from armour.analysis.evaluate import evaluate
from armour.files import shipped
from armour.scenario.inputs import BACKING, INPUTS, OBLIQUITY
from armour.scenario.scenario import load_scenario
from tools.campaigns.verdict import verdict

Floats = NDArray[np.float64]
EXPONENTS = np.arange(0.0, 2.01, 0.1)


class Tests(NamedTuple):
    """Oblique tests: measured over computed limits by exponent, (exponents, n), and by the normal component, (n,)."""

    metals: NDArray[np.str_]
    alloys: NDArray[np.str_]
    by_exponent: Floats
    by_component: Floats


def oblique_tests() -> Tests:
    """Return the tests of armour-piercing cores at 15 and 30 degrees."""
    with (shipped("scenarios") / "tests" / "plates.csv").open() as file:
        rows = [
            row
            for row in csv.DictReader(file)
            if row["kind"] == "armour-piercing" and 0.0 < float(row[OBLIQUITY]) <= 30.0
        ]
    columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name in INPUTS}
    cosines = np.cos(np.radians(columns.pop(OBLIQUITY)))
    measured = np.array([float(row["ballistic_limit_m_s"]) for row in rows])

    def limits(exponent: float) -> Floats:
        thick = {**columns, BACKING: columns[BACKING] / cosines**exponent}
        found: Floats = evaluate(load_scenario("bare_plate"), thick, ["ballistic_limit_m_s"])["ballistic_limit_m_s"]
        return found

    return Tests(
        np.array([row["metal"] for row in rows]),
        np.array([row["plate"] for row in rows]),
        np.array([measured / limits(float(exponent)) for exponent in EXPONENTS]),
        measured * cosines / limits(0.0),
    )


def errors(tests: Tests, of: NDArray[np.bool_]) -> dict[str, Floats]:
    """Return relative errors of the computed limits of some tests, by rule; of each alloy without its own tests."""
    ratios, alloys = tests.by_exponent[:, of], tests.alloys[of]
    exponents = np.empty(len(alloys))
    for alloy in np.unique(alloys):
        rest = ratios[:, alloys != alloy]
        fine = np.linspace(EXPONENTS[0], EXPONENTS[-1], 201)
        squares = [np.mean((1.0 / at(rest, np.full(rest.shape[1], n)) - 1.0) ** 2) for n in fine]
        exponents[alloys == alloy] = fine[int(np.argmin(squares))]
    return {
        "t/cos": 1.0 / at(ratios, np.ones(len(alloys))) - 1.0,
        "t/cos^n, n fitted": 1.0 / at(ratios, exponents) - 1.0,
        "normal component of the velocity": 1.0 / tests.by_component[of] - 1.0,
    }


def at(ratios: Floats, exponents: Floats) -> Floats:
    """Return ratios at exponents, (n,), between those of the table."""
    return np.array([np.interp(n, EXPONENTS, column) for n, column in zip(exponents, ratios.T, strict=True)])


def main() -> int:
    """Print mean and RMS errors by rule and metal; the rule of the program must not be worse than another on both."""
    tests, rms = oblique_tests(), {}
    print("| rule | metal | tests | mean error, % | RMS error, % |\n|---|---|---:|---:|---:|")
    for words in ("steel", "aluminium", "both"):
        of = tests.metals == words if words != "both" else tests.metals != ""
        for rule, found in errors(tests, of).items():
            rms[rule] = 100.0 * float(np.sqrt(np.mean(found**2)))
            print(f"| {rule} | {words} | {len(found)} | {100.0 * found.mean():+.1f} | {rms[rule]:.1f} |")
    text = ", ".join(f"{rule} {value:.1f}" for rule, value in rms.items())
    return verdict(f"RMS error of {len(tests.metals)} tests, %: {text}", right=rms["t/cos"] == min(rms.values()))


if __name__ == "__main__":
    sys.exit(main())
