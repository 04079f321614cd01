"""``armour figures``."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from armour.cli.console import progress
from armour.cli.runner import check_outputs, say_if_compiling, write
from armour.errors import InputError, Problem


def figures(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder to draw to.", show_default=False)],
    only: Annotated[
        str, typer.Option(metavar="TEXT", help="Draw only figures whose name contains the text.", show_default=False)
    ] = "",
    image: Annotated[Literal["png", "svg"], typer.Option("--format", help="Format of the figures.")] = "png",
) -> None:
    """Draw the paper's figures.

    These are figs. 3 to 14 and the parity of table 3; the curves of each are written as CSV beside it.
    """
    from armour.reporting import charts, plots
    from armour.reporting.table import csv_text
    from armour.reporting.tables.validation import figure_table, parity_table
    from armour.validation.figures import PARITY, compute_figure, paper_figures, parity_of_table_3, read_figures

    path = paper_figures()
    sections = read_figures(path)
    chosen = [section for section in sections if only in section.name]
    parity = only in PARITY
    if not chosen and not parity:
        known = ", ".join([*(section.name for section in sections), PARITY])
        raise InputError([Problem("figures", "--only", f'must be part of a name, found "{only}"; there are {known}')])
    _make(folder)
    say_if_compiling()
    total = len(chosen) + parity
    # Each figure is written as soon as it is computed: all of them take a while.
    with progress("figures") as count:
        for section in chosen:
            figure = compute_figure(section, path.parent)
            write(folder / f"{figure.name}.csv", csv_text(figure_table(figure)))
            write(folder / f"{figure.name}.{image}", plots.rendered(charts.figure_chart(figure), f".{image}"))
            count(total)
        if parity:
            result = parity_of_table_3()
            write(folder / f"{PARITY}.csv", csv_text(parity_table(result)))
            write(folder / f"{PARITY}.{image}", plots.rendered(charts.parity_chart(result), f".{image}"))
            count(total)


def _make(folder: Path) -> None:
    """Make the folder, and check that it can be written to."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        raise InputError([Problem(str(folder), "", "must be a folder or free to be made one")]) from None
    check_outputs(folder / "fig03.csv")
