"""Read tables of offers: armours on sale, with their prices, in the place of the armour of a scenario."""

from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, NamedTuple

from armour.columns import column_of, columns_of
from armour.csv_files import CsvRow, TableKind, TableRead, open_table, read_rows
from armour.errors import InputError, Problem, refuse
from armour.foreign import Rows
from armour.scenario.inputs import BACKING, CERAMIC, LAYERS, NAMES
from armour.scenario.scenario import Scenario

# Keys of materials by those of their thicknesses; of the price; and a column whose plates are names of metals.
MATERIALS = dict(zip(LAYERS, (NAMES["ceramic"], NAMES["backing"]), strict=True))
PRICE, PLATE = "cost_per_m2", "plate"
KEYS = (*LAYERS, *MATERIALS.values(), PRICE, PLATE)
# Columns of a usual table, for messages.
USUAL = "ceramic, ceramic thickness (mm), metal, metal thickness (mm), price per m2"


class Offer(NamedTuple):
    """An armour on offer, from a row of a table."""

    name: str  # its first label, or else its place in the table
    labels: dict[str, str]  # cells of the columns that are kept, by name
    scenario: Scenario  # the scenario that is asked about, with this armour
    cost_per_m2: float | None  # its price or, without a column of prices, the cost by the scenario


class Offers(NamedTuple):
    """The offers of a table, and how it was read."""

    offers: list[Offer]
    read: TableRead


def read_offers(
    scenario: Scenario, table: str | PathLike[str] | Rows, keep: Sequence[str] = (), sheet: str | None = None
) -> Offers:
    """Read a table of offers, an armour in each row; an InputError has every mistake, with its row and column.

    Each row replaces the layers of the scenario's armour that have a column of thicknesses.  Columns of the names in
    `keep` are labels, of which the first names the offers.
    """
    keys = {name: column.key if (column := column_of(name, KEYS)).known else name for name in keep}
    labels = [key for key in keys.values() if key not in KEYS] or ["offer"]
    kind = TableKind("offer", (*LAYERS, PRICE), (*labels, *MATERIALS.values(), PLATE), usual=USUAL)
    source = open_table(table, lambda name: column_of(name, kind.keys).known, sheet, own=True)
    source.check_kept(keep)
    found = read_rows(source, kind, closed=False)  # each offer is checked by itself
    names = {column.key: name for name, column in zip(source.header, columns_of(source.header, kind.keys), strict=True)}
    if PLATE in names and MATERIALS[BACKING] not in names:
        names[MATERIALS[BACKING]] = names.pop(PLATE)
    refuse(Problem(source.file, key, message) for key, message in _wrong_columns(names))
    offers = []
    for row in found.rows:
        if PLATE in row.texts:
            row.texts.setdefault(MATERIALS[BACKING], row.texts[PLATE])
        changes, wrong = _offered_layers(row, names)
        try:
            changed = scenario.replaced(changes)
        except InputError as error:
            changed, wrong = scenario, [*wrong, *((problem.key, problem.message) for problem in error.problems)]
        if not scenario.counts_backing and _plate(changed) != _plate(scenario):
            wrong.append((BACKING, "must be the plate of [armour], as design.existing says that it exists"))
        for key, message in wrong:
            source.wrong(f"{row.place}: {names.get(key, key)}", message)
        kept = {name: row.texts.get(key, "") for name, key in keys.items()}
        cost = row.numbers.get(PRICE) if PRICE in names else changed.cost_per_m2()
        offers.append(Offer(next(iter(kept.values()), row.place), kept, changed, cost))
    source.refuse()
    return Offers(offers, found.read)


def _plate(scenario: Scenario) -> tuple[str, float]:
    """Return the metal of the back plate and its thickness, mm."""
    return scenario.armour.backing, scenario.armour.backing_thickness_mm


def _wrong_columns(names: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield each mistake in the columns of a table of offers, as column and message; `names` has the columns by key."""
    if PLATE in names:
        yield names[PLATE], f"must not be given with {names[MATERIALS[BACKING]]}, which names the metal too"
    for thickness, material in MATERIALS.items():
        if material in names and thickness not in names:
            message = f'must have its thickness in another column, such as "{names[material]} thickness (mm)"'
            yield names[material], message
    if not {*LAYERS} & {*names} and not {*MATERIALS.values()} & {*names}:
        yield "", f"must have the thickness of a layer in a column, such as {USUAL}"


def _offered_layers(row: CsvRow, names: Mapping[str, str]) -> tuple[dict[str, Any], list[tuple[str, str]]]:
    """Return the layers that a row offers, by key of the scenario, and the mistakes in its cells, as key and message.

    `names` has the columns by key; a layer without a column of thicknesses stays the scenario's own.
    """
    changes, wrong = dict[str, Any](), list[tuple[str, str]]()
    for thickness, material in MATERIALS.items():
        if thickness not in names:
            continue
        name, millimetres = row.texts.get(material), row.numbers.get(thickness)
        if thickness == CERAMIC and not name and not row.texts.get(thickness, "0").strip("0.,"):
            changes |= {material: None, thickness: 0.0}  # a bare plate
            continue
        if thickness not in row.texts:
            wrong.append((thickness, 'must be a number, found ""'))
        if material in names and not name:
            wrong.append((material, 'must be a name, found ""'))
        changes |= {} if millimetres is None else {thickness: millimetres}
        changes |= {material: name} if name else {}
    if row.numbers.get(PRICE, 0.0) < 0.0:
        wrong.append((PRICE, f"must be at least 0, found {row.texts[PRICE]}"))
    return changes, wrong
