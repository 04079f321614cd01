"""Write docs/performance.md: ``python -m benchmarks.report RESULTS.json PAGE.md`` with results of pytest-benchmark."""

import json
import os
import sys
from pathlib import Path
from typing import Any


def page(results: dict[str, Any]) -> str:
    """Return the page as Markdown."""
    rows = [{**b["extra_info"], "seconds": b["stats"]["min"]} for b in results["benchmarks"]]
    of = {
        what: [row for row in rows if row["what"] == what]
        for what in ("impact", "limit", "growth", "process", "memory")
    }
    engine = {what: next(row for row in of[what] if row["name"] == "engine, one core") for what in ("impact", "limit")}
    limits = {row["name"]: row["each"] / row["seconds"] for row in of["limit"]}
    cores = os.cpu_count()
    return f"""# Performance

Written by `make bench` from one run on a machine with {cores} cores. All methods compute the same random designs for
both projectiles of the paper, with settings for which their errors are of the same size. The error is the largest
difference of a ballistic limit from that of plain Python with time steps 20 times shorter.

## An impact, 5 % above the ballistic limit

{_compared(of["impact"], engine["impact"])}

`solve_ivp` needs a short longest step. Without it, at any tolerance, it misses plates that move for less than a step,
and its limits are off by up to 10 m/s.

## A ballistic limit

{_compared(of["limit"], engine["limit"])}

The engine finds {limits["engine, all cores"]:,.0f} limits per second on all cores and
{limits["engine, one core"]:,.0f} on one, a ratio of {limits["engine, all cores"] / limits["engine, one core"]:.2f}.

## Time by number of impacts

| impacts | seconds | µs per impact |
|---:|---:|---:|
{_lines(f"| {row['each']:,} | {row['seconds']:.4f} | {_each(row):.2f} |" for row in of["growth"])}

## Time and memory of a sweep to CSV

| rows | seconds | peak MiB |
|---:|---:|---:|
{_lines(f"| {row['each']:,} | {row['seconds']:.1f} | {row['peak_MiB']:.0f} |" for row in of["memory"])}

## Time of a whole process

| process | seconds |
|---|---:|
{_lines(f"| {row['name']} | {row['seconds']:.2f} |" for row in of["process"])}
"""


def _compared(rows: list[dict[str, Any]], engine: dict[str, Any]) -> str:
    head = "| method | µs each | relative to the engine | error, m/s |\n|---|---:|---:|---:|\n"
    return head + _lines(
        f"| {row['name']} | {_each(row):,.1f} | {_each(row) / _each(engine):,.2f} | {row['error_m_s']:.1g} |"
        for row in sorted(rows, key=_each)
    )


def _each(row: dict[str, Any]) -> float:
    return 1e6 * float(row["seconds"]) / int(row["each"])


def _lines(lines: Any) -> str:
    return "\n".join(lines)


if __name__ == "__main__":
    Path(sys.argv[2]).write_text(page(json.loads(Path(sys.argv[1]).read_text())))
