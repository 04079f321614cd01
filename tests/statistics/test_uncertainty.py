"""Uncertainty against brute force and distributions that are known."""

from typing import Any

import numpy as np
import pytest
from scipy import stats

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.evaluate import evaluate
from armour.analysis.samples import Samples
from armour.analysis.variants import variants_of
from armour.design.check import check
from armour.errors import InputError, NoLimitError
from armour.scenario.scenario import Scenario
from armour.statistics import uncertainty as module
from armour.statistics.uncertainty import (
    QUANTILES,
    probability_curve,
    quantile,
    sample_limits,
    uncertainty,
)
from tests.helpers.cases import scenario, shipped_scenario
from tests.helpers.known import known

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def uncertain() -> Scenario:
    return shipped_scenario("uncertain").replaced({"uncertainty.model": EXACT})


EXACT = {"included": False}


def with_section(**section: Any) -> Scenario:
    return scenario(uncertainty={"model": EXACT, **section})


def independent_samples(samples: int, seed: int) -> dict[str, np.ndarray]:
    """Independent samples by scipy's own distributions, not by this project's."""
    rng = np.random.default_rng(seed)
    shape = np.sqrt(np.log(1.0 + 0.06**2))
    strength = stats.truncnorm((300.0 - 372.0) / 14.88, np.inf, 372.0, 14.88)
    return {
        "impact.velocity_m_s": rng.normal(700.0, 5.0, samples),
        "armour.ceramic_thickness_mm": rng.uniform(6.25, 6.45, samples),
        "projectile.penetrator_mass_g": rng.normal(5.46, 0.0546, samples),
        "ceramic.flow_stress_GPa": rng.lognormal(np.log(5.2) - 0.5 * shape**2, shape, samples),
        "backing.dynamic_yield_strength_MPa": strength.rvs(samples, random_state=rng),
    }


@pytest.fixture(scope="module")
def sampled(uncertain: Scenario) -> tuple[int, np.ndarray]:
    """Perforations of 16,384 independent samples, and ballistic limits of 4,096 of them."""
    samples = variants_of(uncertain, independent_samples(16_384, 1), 16_384)
    return int(samples.perforated().sum()), sample_limits(Samples(samples.at(np.arange(4_096)), 1.0))


def test_independent_samples_agree_within_the_interval(uncertain: Scenario, sampled: tuple[int, np.ndarray]):
    result = uncertainty(uncertain.replaced({"uncertainty.samples": 2048}))
    hits, limits = sampled
    chance: Any = stats.binomtest(hits, 16_384).proportion_ci()
    assert result.probability_of_perforation is None
    alone = known(result.perforated_by_distributions)
    assert alone.low < chance.high
    assert alone.high > chance.low
    for part in QUANTILES:
        estimate = result.limit_quantiles_m_s[str(part)]
        independent: Any = stats.quantile_test(limits, p=part).confidence_interval()
        assert estimate.low < independent.high
        assert estimate.high > independent.low
    assert result.standard_deviation_m_s == pytest.approx(limits.std(), rel=0.02)


def test_the_same_seed_gives_the_same_numbers():
    normal = {"distribution": "normal", "standard_deviation_percent": 2.0}
    few = with_section(ceramic={"flow_stress_GPa": normal, "density_kg_m3": normal}, samples=128)
    first = uncertainty(few)
    assert first == uncertainty(few) != uncertainty(few.replaced({"uncertainty.seed": 2}))


def test_the_error_of_the_model_is_an_input():
    """Of the probability and the quantiles, against the distribution from tests."""
    result = uncertainty(scenario(velocity=700.0, uncertainty={"samples": 2048}))
    error = known(result.model_error)
    assert result.deterministic_m_s == pytest.approx(723.77, abs=0.01)
    exact = 1.0 - error.probability_of_stopping(result.deterministic_m_s, 700.0)
    assert known(result.probability_of_perforation).value == pytest.approx(exact, abs=0.002)
    for part in QUANTILES:
        limit = result.deterministic_m_s * (1.0 + error.quantile(part))
        estimate = result.limit_quantiles_m_s[str(part)]
        assert estimate.low < limit < estimate.high
    velocities = np.array(result.curve.velocity_m_s)
    curve = 1.0 - error.probability_of_stopping(result.deterministic_m_s, velocities)
    assert np.abs(np.array(result.curve.probability) - curve).max() < 0.01
    [index] = result.inputs
    assert index.input == "model.limit_error_percent"
    assert index.limits_m_s == pytest.approx([723.77 * (1.0 + error.quantile(p)) for p in (0.05, 0.95)], abs=0.01)


def test_the_error_of_the_model_adds_to_the_inputs(uncertain: Scenario):
    few = uncertain.replaced({"uncertainty.samples": 512})
    alone = uncertainty(few)
    error_section = {"scale_percent": 5.0, "degrees_of_freedom": 30.0, "source": "tests"}
    both = uncertainty(few.replaced({"uncertainty.model": {"included": True, **error_section}}))
    expected = np.hypot(alone.standard_deviation_m_s, 0.05 * np.sqrt(30.0 / 28.0) * alone.mean_m_s)
    assert both.standard_deviation_m_s == pytest.approx(expected, rel=0.02)
    assert both.inputs[0].input == "model.limit_error_percent"


def test_samples_by_several_laws_are_the_mixture():
    """The sampled probability is the mean, over samples of the inputs, of the probability that `confidence` gives."""
    normal = {"distribution": "normal", "standard_deviation_percent": 2.5}
    case = scenario(velocity=724.0, uncertainty={"samples": 256, "ceramic": {"flow_stress_GPa": normal}})
    values = stats.norm(5.2, 0.13).ppf((np.arange(50) + 0.5) / 50)
    [exact] = evaluate(case, {"ceramic.flow_stress_GPa": values}, ["probability_of_stopping"]).values()
    assert 1.0 - exact.mean() == pytest.approx(known(uncertainty(case).probability_of_perforation).value, abs=0.004)


def test_the_effect_of_an_input_is_that_of_changed_scenarios(uncertain: Scenario):
    """With the input at two quantiles of its distribution; the input with the widest range comes first."""
    result = uncertainty(uncertain.replaced({"uncertainty.samples": 128}))
    found = {influence.input: influence.limits_m_s for influence in result.inputs}
    mass = "projectile.penetrator_mass_g"
    changed = [uncertain.with_inputs({mass: float(stats.norm(5.46, 0.0546).ppf(chance))}) for chance in (0.05, 0.95)]
    assert found[mass] == pytest.approx([ballistic_limit(each).ballistic_limit_m_s for each in changed], abs=1e-6)
    widths = [abs(high - low) for low, high in found.values()]
    assert widths == sorted(widths, reverse=True)


def test_an_unknown_error_is_told():
    normal = {"distribution": "normal", "standard_deviation_percent": 2.0}
    result = uncertainty(scenario(ceramic="SiC", uncertainty={"samples": 128, "ceramic": {"flow_stress_GPa": normal}}))
    assert result.model_error is None
    unknown = "uncertainty.model: the model error is not known for such an armour, and not included"
    assert unknown in result.warnings
    assert [index.input for index in result.inputs] == ["ceramic.flow_stress_GPa"]
    assert (result.probability_of_perforation, result.curve.probability) == (None, None)
    assert list(next(iter(result))) == ["velocity_m_s", "by_distributions", "low", "high"]
    assert 0.0 <= known(result.perforated_by_distributions).value <= 1.0


@pytest.mark.parametrize("case", [{"ceramic": "SiC"}, {}, {"ceramic": None, "ceramic_mm": 0.0, "backing_mm": 25.0}])
def test_the_probability_is_known_where_check_knows_it(case: dict[str, Any]):
    normal = {"distribution": "normal", "standard_deviation_percent": 1.0}
    section = {"uncertainty": {"samples": 128, "projectile": {"penetrator_mass_g": normal}}}
    of = scenario(**case, velocity=700.0, **section, design={"probability_of_stopping": 0.9})
    [threat], found = check(of).threats, uncertainty(of)
    if threat.probability_of_stopping is None:
        assert (found.probability_of_perforation, found.curve.probability) == (None, None)
    else:
        perforated = known(found.probability_of_perforation)
        assert threat.probability_of_stopping == pytest.approx(1.0 - perforated.value, abs=1e-3)
        assert (found.perforated_by_distributions, found.curve.by_distributions) == (None, None)


def test_beyond_the_tested_thicknesses_the_probability_is_bounded():
    found = uncertainty(scenario(ceramic_mm=12.0, backing_mm=8.0, velocity=600.0, uncertainty={"samples": 128}))
    least = 1.0 - known(found.model_error).greatest_probability
    assert known(found.probability_of_perforation).value == min(known(found.curve.probability)) == least > 0.1


def test_only_the_velocity():
    result = uncertainty(
        with_section(impact={"velocity_m_s": {"distribution": "uniform", "min": 713.77, "max": 743.77}}, samples=1024)
    )
    assert result.inputs == ()
    assert known(result.perforated_by_distributions).value == pytest.approx(2.0 / 3.0, abs=0.003)
    assert result.standard_deviation_m_s == 0.0


def test_correlation_of_inputs_that_act_alike_widens_the_limit():
    normal = {"distribution": "normal", "standard_deviation_percent": 3.0}
    names = ["ceramic.density_kg_m3", "ceramic.flow_stress_GPa"]
    section = {"ceramic": {"density_kg_m3": normal, "flow_stress_GPa": normal}, "samples": 256}
    alone = uncertainty(with_section(**section))
    together = uncertainty(with_section(**section, correlation=[{"between": names, "coefficient": 0.8}]))
    assert together.inputs == alone.inputs
    assert together.standard_deviation_m_s > alone.standard_deviation_m_s


def test_the_interval_of_a_quantile_from_few_samples():
    tenth = quantile(np.random.default_rng(1).permutation(np.arange(1.0, 101.0)), 0.1)
    # Ten of a hundred, fewer than replicates: the interval of Clopper and Pearson of the probability is 0.049 to 0.176.
    assert (tenth.low, tenth.value, tenth.high) == pytest.approx((5.9, 10.9, 18.5), abs=0.1)


def test_the_band_of_the_curve():
    curve = probability_curve(np.random.default_rng(1).normal(700.0, 20.0, 2000), 1.0)
    truth = stats.norm(700.0, 20.0).cdf(curve.velocity_m_s)
    inside = (np.array(curve.low) <= truth) & (truth <= np.array(curve.high))
    assert inside.mean() > 0.9
    assert known(curve.probability)[:: len(curve.velocity_m_s) - 1] == (0.0, 1.0)
    assert curve.low[0] == 0.0
    assert curve.high[-1] == 1.0


OTHER = "does not contain the scenario's value, 6.35"


@pytest.mark.parametrize(
    ("distribution", "told"),
    [
        ({"distribution": "uniform", "min": 6.0, "max": 6.5}, []),
        ({"distribution": "uniform", "min": 7.0, "max": 8.0}, [OTHER]),
        ({"distribution": "normal", "mean": 6.3, "standard_deviation": 0.1}, []),
        ({"distribution": "normal", "mean": 7.0, "standard_deviation_percent": 1.0}, [OTHER]),
        (
            {"distribution": "normal", "standard_deviation": 0.2, "min": 6.35},
            ["truncation moves its mean from 6.35 to"],
        ),
    ],
)
def test_what_a_distribution_and_threats_warn_of(distribution: dict[str, Any], told: list[str]):
    case = with_section(samples=128, armour={"ceramic_thickness_mm": distribution})
    case = case.replaced({"threat": [{"projectile": "7.62 mm APM2", "velocity_m_s": 800.0}]})
    *warnings, last = (
        warning for warning in uncertainty(case).warnings if warning.startswith(("uncertainty.", "threat"))
    )
    assert len(warnings) == len(told)
    for warning, words in zip(warnings, told, strict=True):
        assert warning.startswith(f"uncertainty.armour.ceramic_thickness_mm: {words}")
    against = f"the {case.impact.projectile} at {case.impact.velocity_m_s:g} m/s of [impact]"
    assert last.startswith(f"threat: is not used: the results are against {against}")


NORMAL = {"distribution": "normal", "standard_deviation_percent": 10.0}
MISSING = "scenario: uncertainty: is missing and must be given"


def lognormal(mean: float | None = None, deviation: float = 1.0) -> dict[str, Any]:
    return {"distribution": "lognormal", "standard_deviation": deviation} | ({} if mean is None else {"mean": mean})


def of_strength(**keys: Any) -> dict[str, Any]:
    return {"uncertainty": {"backing": {"shear_strength_MPa": keys}}}


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({}, MISSING),
        ({"uncertainty": {"samples": 128, "model": EXACT}}, MISSING),
        ({"ceramic": "SiC", "uncertainty": {}}, MISSING),
        (of_strength(distribution="normal", standard_deviation_percent=60.0), "; give it a min or max"),
        (
            {"ceramic": None, "ceramic_mm": 0.0, "uncertainty": {"ceramic": {"flow_stress_GPa": NORMAL}}},
            'found "ceramic.flow_stress_GPa"',
        ),
        (of_strength(**lognormal(0.0)), "must have a mean greater than 0"),
        (of_strength(**NORMAL, mean=0.0), "and not one in per cent"),
        (of_strength(**lognormal(deviation=1e300)), "must be at most 1e+09"),
    ],
)
def test_wrong_sections(keywords: dict[str, Any], message: str):
    with pytest.raises(InputError) as error:
        uncertainty(scenario(**keywords))
    assert message in str(error.value)


def test_samples_without_a_limit():
    case = scenario(
        uncertainty={"ceramic": {"flow_stress_GPa": NORMAL}, "samples": 128},
        ballistic_limit={"velocity_max_m_s": 740.0},
    )
    with pytest.raises(NoLimitError, match="some samples have no ballistic limit between 20 and 740 m/s"):
        uncertainty(case)


def test_samples_are_computed_in_portions(monkeypatch: pytest.MonkeyPatch):
    normal = {"distribution": "normal", "standard_deviation_percent": 2.0}
    case = with_section(ceramic={"flow_stress_GPa": normal}, armour={"backing_thickness_mm": normal}, samples=128)
    whole, done = uncertainty(case), []
    monkeypatch.setattr(module, "SAMPLES_AT_A_TIME", 50)
    assert uncertainty(case, on_progress=lambda *counts: done.append(counts)) == whole
    assert max(count for count, _ in done) <= 50
    assert {total for _, total in done} == {sum(count for count, _ in done)}
