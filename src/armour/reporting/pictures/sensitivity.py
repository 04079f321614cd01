"""Picture of a sensitivity analysis: the elasticities of every answer, side by side."""

from armour.analysis.quantities import label_and_unit
from armour.reporting.pictures import drawing
from armour.statistics.sensitivity import SensitivityResult


def draw(result: SensitivityResult, sheet: drawing.Sheet) -> drawing.Picture:
    """Draw them, the inputs with the largest of the first answer, the ballistic limit where there is one, on top."""
    answers = [name for name, value in result.answers.items() if value is not None]
    # Without an elasticity an input, such as the velocity for the ballistic limit, is below those with one.
    inputs = sorted(
        (item for item in result.inputs if any(item.elasticities[answer] is not None for answer in answers)),
        key=lambda item: [-abs(item.elasticities[answer] or 0.0) for answer in answers],
    )
    names, titles = [label_and_unit(item.input)[0] for item in inputs], [label_and_unit(name)[0] for name in answers]
    title, note = "", "Change in % for a 1 % increase of the input."
    if inputs:
        most = inputs[0].elasticities[answers[0]] or 0.0
        title = f"The {titles[0]} depends most on the {names[0]}: {most:+.2f} % for 1 % more"
    heights = [drawing.rows_height(names, titled=True)] * len(answers)
    picture = sheet.panels(title, *heights, note=note, beside=True, sharey=True)
    for axes, answer, heading in zip(picture.axes, answers, titles, strict=True):
        drawing.rows(axes, names, {"": [item.elasticities[answer] for item in inputs]}, 0.0)
        axes.set(title=heading, xlabel="change, %")
    return picture
