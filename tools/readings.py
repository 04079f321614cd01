"""Compare four readings with all that the paper prints, and write the table of docs/readings.md.

    python -m tools.readings

The plate is driven by its strength or by the interface, and has the flow stress of table 2 or that of 6061-T6.  For
each reading three numbers are fitted to all that is printed: the diameters of both penetrators, and the shear strength
over the yield strength.
"""

import re
from collections.abc import Iterable, Sequence
from math import sqrt
from pathlib import Path
from typing import Any, NamedTuple

from scipy.optimize import least_squares

from armour.scenario.scenario import Scenario
from armour.validation.questions import Subject, answer
from armour.validation.suite import Case, load_suite
from armour.validation.validate import Check

PAGE = Path(__file__).parents[1] / "docs" / "readings.md"
SMALL, MEDIUM = "the paper's lightest against the 7.62 mm AP", "the paper's lightest against the 25 mm APDS"
FIG_3, FIG_4 = "Al-N on 7075-T6, equal thicknesses", "AD99.5 on 35 mm 7075-T6"
FIG_9 = "4 mm AD85 on 8 mm 5083-H3", "11 mm AD85 on 8 mm 5083-H3"
FIG_10 = "20 mm AD99.5 on 30 mm 5083-H3", "36 mm AD99.5 on 30 mm 5083-H3"
FIGURES = FIG_9, FIG_10
FIG_11 = "10.04 mm AD85 on 8 mm 5083-H3", "7.03 mm AD99.5 on 8 mm 5083-H3"
FIG_12 = "29.2 mm AD85 on 30 mm 5083-H3", "21.3 mm AD99.5 on 30 mm 5083-H3"
TABLE_3 = "table 3, the paper's program, 3.8 GPa", "table 3, the paper's program, 5.2 GPa"
# Standard deviations of limits, m/s, by the table or the beginning of the name of a case.
LIMITS = {**dict.fromkeys((*TABLE_3, SMALL), 2.0), MEDIUM: 4.0, FIG_3: 10.0, FIG_4: 6.0}
LIMITS |= {**dict.fromkeys(FIG_11, 5.0), **dict.fromkeys(FIG_12, 30.0)}
# Those of the velocity and the mass that are lost, per cent; the second projectile of fig. 9 is just above its limit.
LOSS, LOSS_AT_LIMIT = 1.0, 3.0
# The table, up to the empty line after it.
TABLE = re.compile(r"^\|  \| paper \|.*?\n(?=\n)", re.MULTILINE | re.DOTALL)
START = (6.4, 0.75, 14.25)
# Thicknesses of the armours of figs. 13 and 14 over those of their back plates.
PARTS = 18.7 / 10.7, 55.7 / 35.7
SAVED = [f"5083-H3 by 7075-T6 against the {fired}: thickness saved" for fired in ("7.62 mm AP", "25 mm APDS")]


class Reading(NamedTuple):
    """What drives the plate, and whether every plate has one flow stress."""

    words: str
    drive: str
    one_flow_stress: bool


READINGS = (
    Reading("(23) as printed", "strength", one_flow_stress=False),
    Reading("(23) as printed, one flow stress", "strength", one_flow_stress=True),
    Reading("interface", "interface", one_flow_stress=False),
    Reading("interface, one flow stress", "interface", one_flow_stress=True),
)


def deviation_of(case: Case) -> float | None:
    """Return the standard deviation by which a printed number is weighted; None for one that depends on others."""
    if case.quantity.endswith("_lost_percent"):
        return LOSS_AT_LIMIT if case.name == f"{FIG_9[1]}: velocity lost" else LOSS
    is_limit = case.quantity == "ballistic_limit_m_s" and case.measured is None
    return LIMITS.get(case.group or case.name.partition(":")[0]) if is_limit else None


def chi_square(checks: Iterable[Check]) -> float:
    """Return the sum of the squares of the weighted deviations from what is printed."""
    weighted = ((check, deviation_of(check.case)) for check in checks)
    return sum((float(check.deviation or 0.0) / deviation) ** 2 for check, deviation in weighted if deviation)


def computed(case: Case, reading: Reading, numbers: Sequence[float]) -> float:
    """Return the number of a case by a reading, given both diameters, mm, with the ratio of strengths between them."""
    return float(answer(case.quantity, Subject(*(_changed(scenario, reading, numbers) for scenario in case.scenarios))))


def _changed(scenario: Scenario, reading: Reading, numbers: Sequence[float]) -> Scenario:
    small, ratio, medium = numbers
    dynamic_yield = scenario.entry("metal", scenario.armour.backing)["dynamic_yield_strength_MPa"]
    values = {
        "projectile.penetrator_diameter_mm": small if scenario.impact.projectile == "7.62 mm AP" else medium,
        "backing.shear_strength_MPa": ratio * dynamic_yield,
    }
    return scenario.with_inputs(values | ({"backing.flow_stress_GPa": 1.05} if reading.one_flow_stress else {}))


class Fitted:
    """A reading with the numbers that fit it best."""

    def __init__(self, reading: Reading) -> None:
        cases = load_suite("paper", {"model.plate_drive": reading.drive}).cases
        self.reading, self.cases = reading, {case.full_name: case for case in cases}
        weighted = [(case, deviation) for case in cases if (deviation := deviation_of(case))]

        def deviations(numbers: Any) -> list[float]:
            return [(computed(case, reading, numbers) - float(case.expected or 0.0)) / s for case, s in weighted]

        best = least_squares(deviations, START, x_scale=(0.1, 0.05, 0.1), diff_step=(1e-4,) * 3, xtol=1e-6, ftol=1e-7)
        self.numbers, self.chi_square = best.x.tolist(), 2.0 * float(best.cost)

    def value(self, name: str) -> float:
        """Return the number of a case."""
        return computed(self.cases[name], self.reading, self.numbers)

    def errors(self, *names: str) -> list[float]:
        """Return the deviations of limits, m/s, from what is printed."""
        full = [name for name in self.cases if name.startswith(names) and self.cases[name].unit == "m/s"]
        return [self.value(name) - float(self.cases[name].expected or 0.0) for name in full]

    def cells(self) -> list[str]:
        """Return the column of the table."""
        small, ratio, medium = self.numbers
        rms = (sqrt(sum(error**2 for error in self.errors(name)) / 13) for name in TABLE_3)
        lost = ("; ".join(self.values(f"{one}: velocity lost", f"{one}: mass lost") for one in of) for of in FIGURES)
        return [
            f"{self.chi_square:.0f}",
            f"{small:.2f}, {ratio:.2f}, {medium:.2f}",
            " / ".join(f"{value:.1f}" for value in rms),
            self.lightest("lightest against the 7.62 mm AP"),
            self.lightest("lightest against the 25 mm APDS"),
            *lost,
            ", ".join(f"{part * saved:.1f}" for part, saved in zip(PARTS, map(self.value, SAVED), strict=True)),
        ]

    def values(self, *names: str) -> str:
        """Return the numbers of cases in words."""
        return ", ".join(f"{self.value(name):.1f}" for name in names)

    def lightest(self, name: str) -> str:
        """Return the lightest armour and its areal density."""
        ceramic, backing, density = (self.value(f"{name}: {of}") for of in ("ceramic", "backing", "areal density"))
        return f"{ceramic:.1f} on {backing:g}, {density:.1f}"


ROWS = (
    ("chi-square", ""),
    ("fitted: core of the 7.62 mm round, mm; shear over yield strength; core of the 25 mm round, mm", ""),
    ("table 3, RMS with 3.8 / 5.2 GPa, m/s", ""),
    ("lightest at 850 m/s, mm, kg/m²", "10.3 on 7, 54.4"),
    ("lightest at 1200 m/s, mm, kg/m²", "58.3 on 24, 289.4"),
    ("fig. 9, lost of the velocity and of the mass, %", "33, 18.7; 93, 34.8"),
    ("fig. 10, lost of the velocity and of the mass, %", "27, 31.9; 48, 42.4"),
    ("figs. 13 and 14, saved of the back plate, %", "9.1, 10"),
)


def table() -> str:
    """Return the table of four readings."""
    readings = [Fitted(reading) for reading in READINGS]
    head = ["", "paper", *(reading.words for reading in READINGS)]
    columns = [fitted.cells() for fitted in readings]
    rows = [[*row, *cells] for row, *cells in zip(ROWS, *columns, strict=True)]
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def main() -> None:
    """Write the table into the page."""
    four = table()
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(TABLE.sub(lambda _: four, page), encoding="utf-8")


if __name__ == "__main__":
    main()
