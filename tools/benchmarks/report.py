"""Run the benchmarks and write a page of them: ``python -m tools.benchmarks.report docs/performance.md``."""

import os
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from textwrap import fill

from armour.errors import duration
from tools.benchmarks import commands, methods
from tools.benchmarks.commands import Commands
from tools.benchmarks.methods import COUNT, Methods


def page(method: Methods, command: Commands) -> str:
    """Return the page as Markdown."""
    text = f"""# Performance

Written by `make bench`, on a machine with {os.cpu_count()} cores. Times are processor time, that is, the times of all
cores together, unless stated otherwise.

## What you wait for

{_waits(command)}

## What grows

A sweep of 500,000 ballistic limits takes {_example(command)}. Up to the numbers of the examples, such sums differ by at
most {100 * max(g.error for g in command.growth):.0f} % from the times measured.

{_growth(command)}

On {os.cpu_count()} cores the engine, that is, the compiled numerical code, finds {method.cores:.1f} times as many
ballistic limits per second as on one.

## Compared with C, scipy and plain Python

Medians of {COUNT:,} random designs, on one core. An impact takes {method.steps:.0f} steps in the mean, and a ballistic
limit {method.runs:.1f} impacts. Ratios are those to the engine.

| method | impact, µs | ratio | limit, µs | ratio |
|---|---:|---:|---:|---:|
{_methods(method)}

{_agreement(method)}

*Plain Python* runs the same functions without compiling them. LSODA, by scipy's `solve_ivp`, has a tolerance of
{methods.TOLERANCE_OF_LSODA:g}: with looser ones, its limits are off by more than 0.002 m/s.
"""
    parts = text.split("\n\n")
    filled = (part if part.startswith(("#", "|")) else fill(part, 120, break_on_hyphens=False) for part in parts)
    return "\n\n".join(filled) + "\n"


def _waits(command: Commands) -> str:
    rows = (f"| `{re.sub(' -.*', '', name)}` | {seconds:.1f} |" for name, seconds in command.waits.items())
    return f"| command | s |\n|---|---:|\n{_lines(rows)}"


def _growth(command: Commands) -> str:
    rows = []
    for g in command.growth:
        example = f"{g.most:,}: {g.seconds:.1f} s"
        rows.append(f"| `{g.command}`: {g.unit} | {g.fixed:.1f} | {_short(g.each)} | {example} |")
    return f"| for each | fixed, s | each | example |\n|---|---:|---:|---:|\n{_lines(rows)}"


def _example(command: Commands) -> str:
    [g] = [g for g in command.growth if g.unit == "ballistic limit"]
    return f"{g.fixed:.1f} s and 500,000 times {_short(g.each)}, {duration(g.fixed + 5e5 * g.each)}"


def _methods(method: Methods) -> str:
    return _lines(
        f"| {name} | {_cells(method.impacts, name)} | {_cells(method.limits, name)} |"
        for name in ("C", "engine", "plain Python", "scipy's LSODA")
        if name in method.impacts
    )


def _cells(each: dict[str, float], name: str) -> str:
    """Return the time of a method and its ratio to the engine's, both empty if it was not measured."""
    if name not in each:
        return " | "
    seconds, ratio = each[name], each[name] / each["engine"]
    return f"{1e6 * seconds:,.{0 if seconds > 1e-3 else 1}f} | {ratio:,.{0 if ratio > 10 else 2}f}"


def _agreement(method: Methods) -> str:
    """Compare the engine with the reference in C."""
    if "C" not in method.impacts:
        return "No C compiler was found for the comparison with C."
    return f"""*C* is `tools/benchmarks/reference.c`, the same computation written by hand and compiled by
`cc {" ".join(methods.FLAGS)}`. Both give the same numbers to the last bit."""


def _short(seconds: float) -> str:
    """Return a short time with its unit, to two digits."""
    unit, factor = ("µs", 1e6) if seconds < 1e-3 else ("ms", 1e3)
    return f"{float(f'{factor * seconds:.2g}'):g} {unit}"


def _lines(lines: Iterable[str]) -> str:
    return "\n".join(lines)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page(methods.measured(), commands.measured()))
