"""``armour figures``."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Literal

import typer

from armour.cli.console import progress
from armour.cli.options import Force, argument, option
from armour.cli.runner import check_outputs, say_if_compiling, write
from armour.errors import InputError, Problem


def figures(
    folder: Annotated[Path, argument("DIR", "Folder to draw to.")],
    only: Annotated[str, option("Draw only figures whose name contains the text.", metavar="TEXT")] = "",
    image: Annotated[Literal["png", "svg"], typer.Option("--format", help="Format of the figures.")] = "png",
    force: Force = False,
) -> None:
    """Draw the paper's figures.

    These are figs. 3 to 14 and the parity of table 3 and of bare plates; the values are written as CSV beside each.
    """
    from armour.reporting import draw
    from armour.reporting.table import csv_text
    from armour.reporting.views import suite
    from armour.validation.figures import PARITIES, compute_figure, paper_figures, parity, read_figures

    path = paper_figures()
    panels = {name: list(group) for name, group in groupby(read_figures(path), attrgetter("name"))}
    names = [*panels, *PARITIES]
    chosen = [name for name in names if only in name]
    if not chosen:
        message = f'must be part of a name, found "{only}"; there are {", ".join(names)}'
        raise InputError([Problem("figures", "--only", message)])
    with _made(folder):
        check_outputs(*(folder / f"{name}.{ending}" for name in chosen for ending in ("csv", image)), force=force)
        say_if_compiling()
        # Each figure is written as soon as it is computed: all of them take a while.
        with progress("figures", len(chosen)) as count:
            for name in chosen:
                if name in PARITIES:
                    result = parity(name)
                    table, chart = suite.parity_table(result), suite.chart(result)
                else:
                    figures = [compute_figure(section, path.parent) for section in panels[name]]
                    table, chart = suite.figure_table(figures), suite.figure_chart(figures)
                drawn = draw.rendered(chart, f".{image}")
                write({folder / f"{name}.csv": csv_text(table), folder / f"{name}.{image}": drawn})
                count(1)


@contextmanager
def _made(folder: Path) -> Iterator[None]:
    """Make a folder and those above it; remove those that stay empty."""
    missing = [path for path in (folder, *folder.parents) if not os.path.lexists(path)]
    try:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            raise InputError([Problem(str(folder), "", "must be a folder or free to be made one")]) from None
        yield
    finally:
        for path in missing:
            with suppress(OSError):
                path.rmdir()
