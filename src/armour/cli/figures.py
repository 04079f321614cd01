"""``armour figures``."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from armour.cli.runner import check_outputs, counting, tell_of_compiling, write, write_plot
from armour.errors import InputError, Problem


class Format(StrEnum):
    """Formats of the figures."""

    PNG = "png"
    SVG = "svg"


def figures(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder to draw to.", show_default=False)],
    only: Annotated[
        str, typer.Option(metavar="TEXT", help="Only figures whose name holds the text.", show_default=False)
    ] = "",
    image: Annotated[Format, typer.Option("--format", help="Format of the figures.")] = Format.PNG,
) -> None:
    """Draw the paper's figs. 3 to 14 and the parity of its table 3, each with its curves as CSV."""
    from armour.reporting.plots import chart_figure, parity_figure
    from armour.reporting.tables import chart_csv, parity_csv
    from armour.validation.figures import PARITY, charts, paper_figures, parity_of_table_3, read_figures

    path = paper_figures()
    chosen = [section for section in read_figures(path) if only in section.name]
    parity = only in PARITY
    if not chosen and not parity:
        known = ", ".join([*(section.name for section in read_figures(path)), PARITY])
        raise InputError([Problem("figures", "--only", f'must be part of a name, found "{only}"; there are {known}')])
    _make(folder)
    tell_of_compiling()
    total = len(chosen) + parity
    with counting("figures") as show:
        for chart in charts(chosen, path.parent):
            write(folder / f"{chart.name}.csv", chart_csv(chart))
            write_plot(folder / f"{chart.name}.{image}", chart_figure(chart))
            show(total)
        if parity:
            result = parity_of_table_3()
            write(folder / f"{PARITY}.csv", parity_csv(result))
            write_plot(folder / f"{PARITY}.{image}", parity_figure(result))
            show(total)


def _make(folder: Path) -> None:
    """Make the folder, and be sure that it can be written to."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        raise InputError([Problem(str(folder), "", "must be a folder or free to be made one")]) from None
    check_outputs(folder / "fig03.csv")
