"""A sensitivity analysis."""

from armour.analysis.quantities import label_and_unit
from armour.reporting import charts
from armour.reporting.table import Column, Source, Table, column_of, in_words, listing, record
from armour.statistics.sensitivity import SensitivityResult

ELASTICITY_NOTE = "% per %: change of the answer, in per cent of it, when the input grows by 1 %"


def sensitivity_table(result: SensitivityResult) -> Table:
    """Return the answers whose elasticities are given."""
    sources: list[Source] = []
    for name, value in result.answers.items():
        none = "none (stopped)" if name == "residual_velocity_m_s" else "none"
        column = Column(label_and_unit(name)[0]) if value is None else column_of(name)
        sources.append((column, none if value is None else value))
    return record(result, *sources)


def elasticity_table(result: SensitivityResult) -> Table:
    """Return the elasticities: the change of each answer that has a value, in per cent, when an input grows by 1 %."""
    answers = [name for name, value in result.answers.items() if value is not None]
    return listing(
        result.inputs,
        (Column("input", prose=True), lambda item: in_words(item.input)),
        column_of("value", "g"),
        *(
            (Column(label_and_unit(name)[0], "% per %", "+.2f"), lambda item, name=name: item.elasticities[name])
            for name in answers
        ),
    )


def tables(result: SensitivityResult) -> list[Table | str]:
    """Return all tables of a sensitivity analysis."""
    return [sensitivity_table(result), elasticity_table(result), ELASTICITY_NOTE]


def chart(result: SensitivityResult) -> charts.Chart:
    """Describe the elasticities of every answer, side by side, the inputs of the largest of the first on top.

    The first is the ballistic limit, where there is one.
    """
    answers = [name for name, value in result.answers.items() if value is not None]
    # Without an elasticity an input, such as the velocity for the ballistic limit, is below those with one.
    inputs = sorted(
        (item for item in result.inputs if any(item.elasticities[answer] is not None for answer in answers)),
        key=lambda item: [-abs(item.elasticities[answer] or 0.0) for answer in answers],
    )
    names = tuple(charts.quantity_axis(item.input).label for item in inputs)
    panels = []
    for answer in answers:
        values = {"": [item.elasticities[answer] for item in inputs]}
        panels.append(
            charts.rows_panel(charts.Axis(spec="+.3f"), names, values, charts.quantity_axis(answer).label, 0.0)
        )
    title, note = "", "Change in % for a 1 % increase of the input."
    if inputs:
        most = inputs[0].elasticities[answers[0]] or 0.0
        what = charts.quantity_axis(answers[0]).label
        title = f"The {what} depends most on the {names[0]}: {most:+.2f} % for 1 % more"
    return charts.Chart(title, tuple(panels), note, beside=True)
