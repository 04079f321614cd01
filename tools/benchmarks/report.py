"""Write docs/performance.md: ``python -m tools.benchmarks.report RESULTS.json PAGE``, results of pytest-benchmark."""

import json
import os
import sys
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from armour.sweeps.cluster import CHUNKS_AHEAD
from armour.sweeps.sweep import CHUNK_S, MAX_CHUNK, duration

Row = dict[str, Any]
# A sweep beyond a machine.
MANY_ROWS, MANY_CORES = 10**9, 1000
# Bytes of a row on its way to a worker: a number for each of two keys.
SENT_BYTES = 16
# Time of a task of the scheduler by the documentation of Dask, s.
DASK_TASK_S = 1e-3


def page(results: dict[str, Any]) -> str:
    """Return the page as Markdown."""
    rows = [{**b["extra_info"], "seconds": b["stats"]["min"]} for b in results["benchmarks"]]
    of = {
        what: [row for row in rows if row["what"] == what]
        for what in ("impact", "limit", "growth", "process", "cost", "workers", "tasks", "client")
    }
    engine = {what: next(row for row in of[what] if row["name"] == "engine, one core") for what in ("impact", "limit")}
    limits = {row["name"]: row["each"] / row["seconds"] for row in of["limit"]}
    cores = os.cpu_count()
    return f"""# Performance

Measured by `make bench` in one run on a machine with {cores} cores. All methods compute the same random designs for
both projectiles of the paper, with settings for which their errors are similar. The error is the largest
difference of a ballistic limit from that of plain Python with time steps 20 times shorter.

## An impact, 5 % above the ballistic limit

{_compared(of["impact"], engine["impact"])}

Without a limit on the step, `solve_ivp` misses plates that move for less than a step, at any tolerance, and its
ballistic limits are off by up to 10 m/s.

## A ballistic limit

{_compared(of["limit"], engine["limit"])}

The engine finds {limits["engine, all cores"]:,.0f} limits per second on all cores and
{limits["engine, one core"]:,.0f} on one, a ratio of {limits["engine, all cores"] / limits["engine, one core"]:.2f}.

## Time by number of impacts

| impacts | seconds | µs per impact |
|---:|---:|---:|
{_lines(f"| {row['each']:,} | {row['seconds']:.4f} | {_each(row):.2f} |" for row in of["growth"])}

## Time of a whole process

| process | seconds |
|---|---:|
{_lines(f"| {row['name']} | {row['seconds']:.2f} |" for row in of["process"])}

{_cost(of["cost"])}

{_scheduler(of["workers"], of["tasks"][0], of["client"])}

{_beyond(of["workers"], of["tasks"][0], of["client"])}
"""


def _cost(rows: list[Row]) -> str:
    """Describe how the time of commands grows, with fits of the least relative errors."""
    summary, measured, example = [], [], ""
    for (command, unit), group in groupby(rows, lambda row: (row["command"], row["unit"])):
        found = list(group)
        number, seconds = (np.array([row[key] for row in found], dtype=float) for key in ("each", "seconds"))
        if len(found) == 1:
            summary.append(f"| `{command}` | {unit} | {seconds[0]:.1f} | | |")
            continue
        columns = np.column_stack([1.0 / seconds, number / seconds])
        fixed, each = np.linalg.lstsq(columns, np.ones(len(found)))[0]
        fitted = fixed + each * number
        error = np.abs(fitted / seconds - 1.0).max()
        summary.append(f"| `{command}` | {unit} | {fixed:.1f} | {_short(each)} | {100 * error:.0f} % |")
        if unit == "ballistic limit":
            example = f"{fixed:.1f} s and 500,000 times {_short(each)}, {duration(fixed + 5e5 * each)}"
        for row, prediction in zip(found, fitted, strict=True):
            times = f"{row['seconds']:.2f} | {prediction:.2f} | {row['peak_MiB']:.0f}"
            measured.append(f"| `{command}` | {unit} | {row['each']:,} | {times} |")
    return f"""## What a command costs

The time of a whole process on all cores consists of a fixed part and a part proportional to the work. A sweep of
500,000 ballistic limits takes {example}. The last column is the largest error of such a prediction over the three
decades measured.

| command | for each | fixed, s | each | error |
|---|---|---:|---:|---:|
{_lines(summary)}

The number of designs is that of all pairs of materials, times the threats. `uncertainty` computes a ballistic limit for
each sample and, for a quarter of the samples, one for each input and one more. The cost of `sensitivity` is constant.

| command | for each | number | seconds | predicted | peak MiB |
|---|---|---:|---:|---:|---:|
{_lines(measured)}"""


def _short(seconds: float) -> str:
    """Return a short time with its unit."""
    return f"{1e6 * seconds:.3g} µs" if seconds < 1e-3 else f"{1e3 * seconds:.3g} ms"


def _scheduler(workers: list[Row], tasks: Row, clients: list[Row]) -> str:
    """Describe sweeps on a cluster of this machine."""
    kinds = {"ballistic_limit_m_s": "ballistic limits", "residual_velocity_m_s": "impacts"}
    lines = []
    for row in sorted(workers, key=lambda row: (row["quantity"], row["workers"])):
        name = f"{row['workers']} worker{'s' * (row['workers'] > 1)}" if row["workers"] else "no cluster, one thread"
        rate = row["each"] / row["seconds"]
        lines.append(f"| {kinds[row['quantity']]} | {name} | {row['chunks']} | {row['seconds']:.1f} | {rate:,.0f} |")
    there, here = _client(clients, cluster=True), _client(clients, cluster=False)
    steps = (
        ("an empty task, submitted and answered", tasks["seconds"] / tasks["each"], None),
        ("a chunk, hashed and written but not computed", here["chunk"], here["row"]),
        ("the same, including transfer to a worker and back", there["chunk"], there["row"]),
        ("joining at the end", there["join_chunk"], there["join_row"]),
    )
    each = (f"| {name} | {_short(chunk)} | {'' if row is None else _short(row)} |" for name, chunk, row in steps)
    return f"""## Sweeps on a Dask cluster

`armour sweep --scheduler` on this machine, with one thread per worker and the compiled code already loaded. Client and
scheduler share the {os.cpu_count()} cores with the workers, so more workers than cores give no speedup.

| rows | computed by | chunks | seconds | rows/s |
|---|---|---:|---:|---:|
{_lines(lines)}

Overhead of a chunk, as a time per chunk and a time per row, from chunks of 10 and of 100,000 rows on two workers:

| step | per chunk | per row |
|---|---:|---:|
{_lines(each)}"""


def _client(clients: list[Row], *, cluster: bool) -> dict[str, float]:
    """Return the seconds for each chunk and row of what a client does, and the bytes of a row."""
    rows = [row for row in clients if row["cluster"] == cluster]
    shapes = np.array([[row["chunks"], row["each"]] for row in rows], dtype=float)
    chunk, row = np.linalg.solve(shapes, [row["write_s"] for row in rows])
    join_chunk, join_row = np.linalg.solve(shapes, [row["join_s"] for row in rows])
    largest = max(rows, key=lambda row: int(row["each"]))
    found = {"chunk": chunk, "row": row, "join_chunk": join_chunk, "join_row": join_row}
    return found | {"check": largest["check_s"] / largest["each"], "bytes": largest["bytes"] / largest["each"]}


def _beyond(workers: list[Row], tasks: Row, clients: list[Row]) -> str:
    """Describe what many rows on many cores need, from what was measured here."""
    client = _client(clients, cluster=True)
    table: dict[str, list[str]] = {}
    first = []
    for quantity, name in (("ballistic_limit_m_s", "limits"), ("residual_velocity_m_s", "impacts")):
        alone = next(row for row in workers if row["quantity"] == quantity and not row["workers"])
        row_s = alone["seconds"] / alone["each"]
        chunk_rows = min(CHUNK_S / row_s, MAX_CHUNK)
        chunks = MANY_ROWS / chunk_rows
        work = MANY_ROWS * row_s
        stages = {
            "scheduler": chunks * max(tasks["seconds"] / tasks["each"], DASK_TASK_S),
            "client": chunks * client["chunk"] + MANY_ROWS * client["row"],
        }
        slowest = max([*stages], key=lambda stage: stages[stage])
        first.append(f"for {name}, the {slowest} at {work / stages[slowest]:,.0f} cores")
        sent = CHUNKS_AHEAD * MANY_CORES * chunk_rows * SENT_BYTES
        cells = {
            "a row on one core": _short(row_s),
            "computing": duration(work / MANY_CORES),
            "chunks, one file each": f"{chunks:,.0f}",
            "chunks per second": f"{chunks / (work / MANY_CORES):,.0f}",
            "the client, checking the rows first": duration(MANY_ROWS * client["check"]),
            "the scheduler, a task for each chunk": duration(stages["scheduler"]),
            "the client, sending and writing": duration(stages["client"]),
            "the client, joining at the end": duration(chunks * client["join_chunk"] + MANY_ROWS * client["join_row"]),
            "disk": f"{2 * MANY_ROWS * client['bytes'] / 1e9:,.1f} GB",
            "rows in transit, in the scheduler": f"{sent / 1e9:,.1f} GB",
            **{f"cores that the {stage} keeps busy": f"{work / s:,.0f}" for stage, s in stages.items()},
        }
        for key, cell in cells.items():
            table.setdefault(key, []).append(cell)
    return f"""## Beyond a machine

Cost of a sweep of 10^9 rows, with two keys and one quantity, to CSV on {MANY_CORES:,} cores: not measured but computed
from the times above, with client and scheduler as fast as here, where they share cores with workers. The documentation
of Dask gives about {_short(DASK_TASK_S)} per task for its scheduler; the longer of the two times is used.

| what | limits | impacts |
|---|---:|---:|
{_lines(f"| {key} | {' | '.join(cells)} |" for key, cells in table.items())}

First bottleneck: {"; ".join(first)}.
Any further cores wait.

* **The client** sends and writes each row; workers group, compute and encode the rows. To use more cores, split the
  values over several sweeps with separate output files, whose clients share nothing.
* **The scheduler** handles one task per chunk. Longer chunks raise its limit; a kill then loses more work.
* **Joining** starts when all rows are computed and uses one core. The disk must hold both the chunks and the table.
* **Chunk files** are in one folder, which is listed a few times; for 100,000 files this takes seconds."""


def _compared(rows: list[Row], engine: Row) -> str:
    head = "| method | µs each | relative to the engine | error, m/s |\n|---|---:|---:|---:|\n"
    return head + _lines(
        f"| {row['name']} | {_each(row):,.1f} | {_each(row) / _each(engine):,.2f} | {row['error_m_s']:.1g} |"
        for row in sorted(rows, key=_each)
    )


def _each(row: Row) -> float:
    return 1e6 * float(row["seconds"]) / int(row["each"])


def _lines(lines: Any) -> str:
    return "\n".join(lines)


if __name__ == "__main__":
    Path(sys.argv[2]).write_text(page(json.loads(Path(sys.argv[1]).read_text())))
