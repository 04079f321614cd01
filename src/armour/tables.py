"""Results as rows: what tables and CSV files show."""

import csv
from collections.abc import Iterable, Sequence
from dataclasses import fields
from io import StringIO
from typing import Any

from armour.library import Kind, Library, LibraryEntry
from armour.limit import LimitResult
from armour.optimisation import Design, OptimumResult
from armour.simulation import History, ImpactResult

# A quantity, its number in words and its unit.
Row = tuple[str, str, str]

STAGES = {
    "i": "intact ceramic, penetrated; rod erodes",
    "ii.1": "fragmented ceramic, penetrated; rod erodes",
    "ii.2": "ceramic carried along or held (dwell); rod erodes",
    "ii.3": "ceramic, penetrated; rod rigid",
    "iii.1": "plate, penetrated; rod erodes",
    "iii.2": "plate carried along or held (dwell); rod erodes",
    "iii.3": "plate, penetrated; rod rigid",
    "iii.4": "plate carried along; rod rigid",
    "iii.5": "fragmented ceramic carried along; rod rigid",
}


def impact_rows(result: ImpactResult) -> list[Row]:
    """An impact's result, quantity by quantity."""
    return [
        ("outcome", result.outcome, ""),
        ("impact velocity", f"{result.impact_velocity_m_s:.2f}", "m/s"),
        ("residual velocity", f"{result.residual_velocity_m_s:.2f}", "m/s"),
        ("residual length", f"{result.residual_length_mm:.3f}", "mm"),
        ("residual mass", f"{result.residual_mass_g:.3f}", "g"),
        ("plug velocity", f"{result.plug_velocity_m_s:.2f}", "m/s"),
        ("penetration depth", f"{result.penetration_depth_mm:.3f}", "mm"),
        ("bulge height", f"{result.bulge_height_mm:.3f}", "mm"),
        ("duration", f"{result.duration_us:.2f}", "us"),
        ("areal density", f"{result.areal_density_kg_m2:.2f}", "kg/m^2"),
    ]


def stage_rows(result: ImpactResult) -> list[tuple[str, ...]]:
    """The stages of an impact, with what each took from the projectile."""
    return [
        (
            record.stage,
            STAGES[record.stage],
            f"{record.start_us:.3f}",
            f"{record.end_us:.3f}",
            f"{record.velocity_lost_m_s:.2f}",
            f"{record.length_lost_mm:.3f}",
            f"{record.energy_lost_J:.1f}",
        )
        for record in result.stages
    ]


STAGE_COLUMNS = (
    "stage",
    "what holds",
    "start us",
    "end us",
    "velocity lost m/s",
    "length lost mm",
    "energy lost J",
)


def limit_rows(result: LimitResult) -> list[Row]:
    """A ballistic limit, quantity by quantity."""
    low, high = result.bracket_m_s
    return [
        ("ballistic limit", f"{result.ballistic_limit_m_s:.2f}", "m/s"),
        ("defeated at", f"{low:.4f}", "m/s"),
        ("perforated at", f"{high:.4f}", "m/s"),
        ("runs", str(result.runs), ""),
        ("areal density", f"{result.areal_density_kg_m2:.2f}", "kg/m^2"),
    ]


def crossing_rows(result: LimitResult) -> list[tuple[str, ...]]:
    """Every change of the outcome."""
    return [
        (f"{crossing.bracket_m_s[0]:.4f}", f"{crossing.bracket_m_s[1]:.4f}", crossing.above)
        for crossing in result.crossings
    ]


CROSSING_COLUMNS = ("below m/s", "above m/s", "outcome above")


def design_rows(result: OptimumResult) -> list[tuple[str, ...]]:
    """The frontier of an optimisation, the lightest design marked."""
    return [
        (
            f"{design.backing_thickness_mm:g}",
            f"{design.ceramic_thickness_mm:g}",
            f"{design.areal_density_kg_m2:.2f}",
            "lightest" if _same(design, result.best) else "",
        )
        for design in result.frontier
    ]


DESIGN_COLUMNS = ("backing mm", "ceramic mm", "areal density kg/m^2", "")


def _same(design: Design, other: Design) -> bool:
    return (design.ceramic_thickness_mm, design.backing_thickness_mm) == (
        other.ceramic_thickness_mm,
        other.backing_thickness_mm,
    )


def best_rows(result: OptimumResult) -> list[tuple[str, ...]]:
    """The lightest designs: of the grid and, where it was asked for, of continuous thicknesses."""
    designs = [("of the grid", result.best)]
    if result.refined is not None:
        designs.append(("refined", result.refined))
    return [
        (
            name,
            f"{design.ceramic_thickness_mm:.3f}",
            f"{design.backing_thickness_mm:.3f}",
            f"{design.areal_density_kg_m2:.3f}",
            "outside the range" if design.ballistic_limit_m_s is None else f"{design.ballistic_limit_m_s:.2f}",
        )
        for name, design in designs
    ]


BEST_COLUMNS = (
    "lightest",
    "ceramic mm",
    "backing mm",
    "areal density kg/m^2",
    "ballistic limit m/s",
)


def library_table(library: Library, kind: Kind) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Columns and rows of the library's entries of a kind: name, numbers and description."""
    entries = library.entries[kind].values()
    keys = list(dict.fromkeys(key for entry in entries for key in entry.values))
    rows = [
        (
            entry.name,
            *(f"{entry[key]:g}" if key in entry.values else "" for key in keys),
            entry.description,
        )
        for entry in entries
    ]
    return (kind, *(key.replace("_", " ") for key in keys), "description"), rows


def entry_rows(entry: LibraryEntry) -> list[tuple[str, str, str, str]]:
    """An entry of the library, value by value, with status and source."""
    return [(key, f"{value.value:g}", value.status, value.source) for key, value in entry.values.items()]


ENTRY_COLUMNS = ("value", "number", "status", "source")


def csv_text(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Rows as a CSV file, numbers in full."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def history_csv(history: History) -> str:
    """A run over time as a CSV file."""
    names = [field.name for field in fields(History)]
    columns = [getattr(history, name).tolist() for name in names]
    return csv_text(names, zip(*columns, strict=True))


def frontier_csv(frontier: Sequence[Design]) -> str:
    """The frontier of an optimisation as a CSV file."""
    names = [field.name for field in fields(Design)]
    return csv_text(names, ([getattr(design, name) for name in names] for design in frontier))
