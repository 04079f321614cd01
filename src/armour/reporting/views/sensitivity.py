"""A sensitivity analysis."""

from armour.analysis.quantities import label_and_unit
from armour.reporting.table import Column, Source, Table, column_of, in_words, listing, record
from armour.statistics.sensitivity import SensitivityResult

ELASTICITY_NOTE = "% per %: change of the answer, in per cent of it, when the input grows by 1 %"


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
    answers: list[Source] = []
    for name, value in result.answers.items():
        none = "none (stopped)" if name == "residual_velocity_m_s" else "none"
        answers.append((Column(label_and_unit(name)[0]), none) if value is None else (column_of(name), value))
    return [record(result, *answers), elasticity_table(result), ELASTICITY_NOTE]
