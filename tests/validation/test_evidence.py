"""The fits and ranges of configs/evidence.toml, from the tests that they are estimated from."""

from typing import Any

import numpy as np
import pytest

from armour.evidence.fit import RODS, shipped_data
from armour.evidence.tests import Evidence, shipped_evidence
from armour.scenario.library import shipped_library
from armour.statistics.calibration import Law
from tests.helpers.cases import TESTS, scenario
from tests.helpers.fits import wilkins_fit
from tools.evidence import GROUPS, Plates, plates_of, tables

pytestmark = pytest.mark.slow

TILES, *PLATES = (evidence for evidence in shipped_evidence() if evidence.fits)
LAWS: dict[str, Law] = {"AD85 backing law": "backing", "AD85 product law": "product"}


def data_of(evidence: Evidence) -> Plates:
    group = GROUPS[evidence.fits[0].name]
    return plates_of(group.kind, group.metal)


def test_the_fits_are_those_of_the_tests():
    """To the digits that two versions of scipy share."""
    made, shipped = tables(), shipped_data()["fit"]
    assert made.keys() == shipped.keys()
    for name, table in made.items():
        assert table.keys() == shipped[name].keys()
        for key in ("terms", "reference", "flow_stress"):
            assert table.get(key) == shipped[name].get(key)
        for key in table.keys() - {"terms", "reference", "flow_stress"}:
            found: Any = table[key]
            assert np.array(found) == pytest.approx(np.array(shipped[name][key]), rel=1e-2, abs=1e-6), (name, key)


@pytest.mark.parametrize("ceramic", LAWS)
def test_the_library_has_the_laws_as_calibrated(ceramic: str):
    entry = shipped_library().entries["ceramic"][ceramic]
    for coefficient in wilkins_fit(LAWS[ceramic]).coefficients:
        key = coefficient.name.split(".")[1]
        assert entry[key] == pytest.approx(coefficient.estimate, abs=6e-4)
        assert coefficient.interval is not None
        low, high = coefficient.interval
        assert entry.values[key].source.endswith(f"95 % interval {low:.2f} to {high:.2f}")


@pytest.mark.parametrize("evidence", PLATES, ids=lambda evidence: evidence.title)
def test_titles_and_ranges_are_those_of_the_tests(evidence: Evidence):
    tests = data_of(evidence)
    assert evidence.title.startswith(f"{len(tests.error)} tests of")
    assert evidence.title.partition(" on ")[2].startswith(f"{len({*tests.alloy})} ")
    assert evidence.obliquity_max_deg == tests.obliquity_deg.max()
    for limits in evidence.measured:
        if limits.name in tests.quantities and limits.name not in RODS:
            column = tests.quantities[limits.name]
            assert limits.low <= column.min() <= 1.06 * limits.low
            assert 0.94 * limits.high <= column.max() <= limits.high


def test_the_ranges_of_tiles_hold_wilkins_tests():
    tests = np.loadtxt(TESTS, delimiter=",", skiprows=1)
    diameter = scenario().core_armour().D0 * 1e3
    for limits in TILES.measured:
        if limits.name.endswith("_thickness_ratio"):
            ratios = tests[:, int(limits.name.startswith("backing"))] / diameter
            assert limits.low <= ratios.min() <= 1.02 * limits.low
            assert 0.98 * limits.high <= ratios.max() <= limits.high
