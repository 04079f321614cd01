"""Every output gives one verdict on random armours with random requirements, that of a plain rule."""

import re
from pathlib import Path

import pytest

from armour.reporting.views.design import amounts, chance_text, limit_text
from armour.scenario.schema import OBJECTIVES
from tests.helpers.browser import needs_chromium
from tests.helpers.verdicts import checked, on_pages, rule, ways

pytestmark = pytest.mark.slow

# Of a hundred, on all of which rule and check agree, a few for each verdict.
SEEDS = (2, 3, 4, 5, 6, 8, 10, 11, 13, 15, 17, 19, 22, 24, 26, 31, 35, 36, 47, 51, 60, 69, 78, 98)


@pytest.mark.parametrize("seed", SEEDS)
def test_every_way_out_says_what_a_plain_rule_says(seed: int, tmp_path: Path):
    assert [way for way, agrees in ways(seed, tmp_path) if not agrees] == []


@pytest.mark.parametrize("seed", SEEDS)
def test_no_number_is_rounded_past_its_bound(seed: int):
    """A probability shown keeps the one required, and a limit the velocity, only where the numbers do."""
    for threat in checked(seed).threats:
        least, percents = threat.required_probability, re.search(r"([\d.]+) %", chance_text(threat))
        if percents and least is not None and threat.probability_of_stopping is not None:
            assert (float(percents[1]) >= 100.0 * least) <= (threat.probability_of_stopping >= least)
        shown = threat.ballistic_limit_m_s if threat.expected_limit_m_s is None else threat.expected_limit_m_s
        if shown is not None:
            needed = threat.velocity_m_s + threat.required_margin_m_s
            assert (float(limit_text(threat).replace(",", "")) >= needed) <= (shown >= needed)
    amounts_of = {row.quantity: row for row in checked(seed).requirements}
    for text, quantity in zip(amounts(checked(seed)).split(", "), OBJECTIVES, strict=False):
        if (row := amounts_of.get(quantity)) and row.found is not None:
            found = float(text.removeprefix("cost ").split()[0].replace(",", ""))
            assert (found <= row.required) <= (row.verdict == "passes")


@needs_chromium
def test_a_page_says_the_same(tmp_path: Path):
    agree = on_pages(SEEDS[::2], tmp_path)
    assert all(agree.values())
    assert len({rule(seed) for seed in agree}) >= 4
