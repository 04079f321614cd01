"""Results of planning."""

from armour.planning.plan_tests import PlannedTest, PlannedTests
from armour.scenario.inputs import CERAMIC


def planned_tests() -> PlannedTests:
    """One planned test of two candidates."""
    values = {"ceramic.flow_stress_GPa": 5.2}
    known = {"ceramic.flow_stress_GPa": 0.3}
    before = PlannedTest(0, {CERAMIC: ""}, None, None, None, dict.fromkeys(values), (None,))
    first = PlannedTest(1, {CERAMIC: 8.0}, 800.0, None, None, {**known}, (20.0,))
    return PlannedTests(
        planned=(before, first),
        criterion="D",
        measure="limit",
        law="constant",
        values=values,
        tests="",
        scatter_percent=3.0,
        scatter_known=True,
        scatter_source="given",
        designs=("wilkins.toml",),
        design_limits_m_s=(720.0,),
        efficiency=1.0,
        not_identified=(),
        candidates={CERAMIC: (6.0, 8.0)},
        sensitivities=(0.8, 1.0),
        confidence=0.95,
        notes=(),
    )
