"""Tables of shots as spreadsheets of several languages export them, at random."""

import codecs
import csv
from dataclasses import dataclass
from io import StringIO
from math import isclose, nan
from pathlib import Path
from random import Random
from typing import NamedTuple

import armour
from armour.errors import InputError


class Locale(NamedTuple):
    """Marks and words of a language."""

    decimal: str
    groups: tuple[str, ...]
    separators: str
    shot: tuple[str, ...]
    velocity: tuple[str, ...]
    result: tuple[str, ...]
    words: tuple[tuple[str, str], ...]
    counts: str
    yes: tuple[str, str]
    remarks: tuple[str, ...]
    title: str


LOCALES = (
    Locale(
        ",",
        (".", "", ""),
        ";;\t",
        ("Schuss", "Schuss-Nr.", "Nr.", "Lfd. Nr."),
        ("Geschwindigkeit", "Auftreffgeschwindigkeit", "v", "V"),
        ("Ergebnis", "Resultat", "Befund"),
        (("kein Durchschlag", "Durchschlag"), ("PP", "CP"), ("gehalten", "durchschlagen"), ("P", "C"), ("nein", "ja")),
        "gültig",
        ("nein", "ja"),
        ("Abplatzer; groß", "Probe naß", 'Kal. "7,62"', "", "Riß 1,5 mm"),
        "Prüfbericht 2026-114",
    ),
    Locale(
        ",",
        ("\u202f", "\u00a0", " ", "", ""),
        ";;\t",
        ("n°", "tir", "N° de tir"),
        ("vitesse", "Vitesse d'impact", "V"),
        ("résultat", "Résultat du tir"),
        (("non perforé", "perforé"), ("Non Perforé", "Perforé"), ("PP", "CP"), ("arrêté", "perforé"), ("non", "oui")),
        "valable",
        ("non", "oui"),
        ("éclats; témoin marqué", "à vérifier", "", "1,5 mm"),
        "Rapport d'essai",
    ),
    Locale(
        ".",
        (",", "", ""),
        ",,\t",
        ("Shot No", "shot", "Shot #", "Round No.", "SHOT NUMBER"),
        ("Velocity", "Impact Velocity", "V", "Striking velocity"),
        ("Result", "RESULT", "Result (PP/CP)", "Outcome"),
        (
            ("PP", "CP"),
            ("partial", "complete"),
            ("Not Perforated", "Perforated"),
            ("partial penetration", "complete penetration"),
            ("P", "C"),
        ),
        "Fair hit",
        ("N", "Y"),
        ("spall, witness", "fair hit: no", "", 'cal. ".30"'),
        "Range report, page 1",
    ),
)
UNITS = {"m/s": 1.0, "ft/s": 0.3048}
# Columns that nobody has to read: names, and what a cell may hold.
HARMLESS: dict[tuple[str, ...], tuple[str, ...]] = {
    ("Operator", "Sch\u00fctze", "Op\u00e9rateur"): ("Meier", "Smith", "Durand"),
    ("Day", "Tag", "Jour"): ("2026-03-02", "2026-03-03"),
    ("Air (\u00b0C)", "Lufttemperatur", "Temp. ambiante"): ("19", "20", "21"),
    ("Camera", "Kamera", "Cam\u00e9ra"): ("yes", "no"),
    ("Chrono", "Messstrecke", "Barri\u00e8re"): ("A", "B", "AB"),
}
# Columns that say which shots count: names, the cell of one that does and of one that does not.
DECIDING = (
    ("Unfair hit", "", "x"),
    ("void", "no", "yes"),
    ("Usable", "Y", "N"),
    ("Shot OK?", "ok", "NOK"),
    ("Code", "", "NFH"),
    ("flag", "0", "1"),
    ("G\u00fcltiger Treffer", "ja", "nein"),
    ("Ausrei\u00dfer", "", "ja"),
    ("Wertbar", "1", "0"),
    ("hors limites", "non", "oui"),
    ("Tir bon", "oui", "non"),
    ("\u00c0 rejeter", "", "X"),
)
# Columns that say under what conditions a shot was fired, of which one is wanted.
CONDITIONS = (
    ("Conditioning", "21 \u00b0C", "-40 \u00b0C"),
    ("Temperatur [\u00b0C]", "21", "60"),
    ("Angle", "0", "30"),
    ("Tile lot", "K1", "K2"),
    ("Projektil Typ", "B32", "M2"),
    ("\u00c9paisseur tuile", "8", "10"),
)
# Remarks by which a shot does not count, and words of which nobody is sure.
REJECTIONS = ("rejected: yaw 8 deg", "Treffer ung\u00fcltig", "tir non retenu", "edge hit, discard", "zu nah am Rand")
DOUBTED = ("{}?", "({})", "{}*", "{} [?]")


@dataclass
class Export:
    """A table as bytes, the shots that it holds, and what must be said to read it."""

    content: bytes
    velocities_m_s: list[float]
    complete: list[bool]
    where: dict[str, str]  # columns that decide, with the cell of the shots that count
    ignore: list[str]  # columns that divide the shots, and need not be read
    remark: str  # name of the column of remarks
    remarks: list[str]  # by which shots that are counted should not
    refused: bool  # whether a result is not certain, or only the yaw says that a shot does not count

    def ends(self, path: Path) -> str:
        """Write the table to a file and read it; return "read", "quoted", "refused", "asked" or what is wrong.

        If columns divide the shots, those that decide are chosen and others ignored, as a person would; a table is
        "asked" about if it is refused although all its rows count.
        """
        path.write_bytes(self.content)
        where, ignore = dict[str, str](), list[str]()
        while True:
            try:
                shots = armour.read_shots(path, where=where, ignore=ignore)
            except InputError as error:
                names = {problem.key for problem in error.problems}
                if self.refused:
                    return "refused"
                if names & {*where, *ignore} or not names <= {*self.where, *self.ignore}:
                    return f"wrong: {error}"
                where |= {name: self.where[name] for name in names & {*self.where}}
                ignore += names - {*where}
                continue
            warnings = "".join(shots.read.warnings if shots.read else ())
            unsaid = [remark for remark in self.remarks if remark not in warnings and self.remark not in ignore]
            if unsaid or not self._holds(shots):
                return f"wrong: read, {shots.read}"
            return "refused" if where else "asked" if ignore else "quoted" if warnings else "read"

    def _holds(self, shots: armour.Shots) -> bool:
        """Return whether the shots are those that count, in this order."""
        return shots.complete == (*self.complete,) and all(map(isclose, shots.velocities_m_s, self.velocities_m_s))


def written(value: float, decimals: int, mark: str, group: str) -> str:
    """Write a number with groups of three digits."""
    whole, _, rest = f"{value:.{decimals}f}".partition(".")
    if len(whole) > 3:
        whole = f"{whole[:-3]}{group}{whole[-3:]}"
    return whole + (mark + rest if rest else "")


def export(dice: Random) -> Export:
    """Make a table by the rules of a spreadsheet: one locale, one format for a column, and what people add."""
    locale = dice.choice(LOCALES)
    unit, decimals, group = dice.choice([*UNITS]), dice.choice((0, 1, 1, 2, 3)), dice.choice(locale.groups)
    middle, count = dice.uniform(250.0, 1400.0), dice.randint(3, 14)
    words, separator = dice.choice(locale.words), dice.choice(locale.separators)
    header = {
        "shot": dice.choice(locale.shot),
        "velocity": dice.choice(locale.velocity)
        + dice.choice((" ({})", " [{}]", ", {}", " {}", " in {}")).format(unit),
        "result": dice.choice(locale.result),
        "yaw": "Yaw (\u00b0)",
        "remark": dice.choice(("Remarks", "Bemerkung", "Remarque")),
        "counts": locale.counts,
        "": "",
    }
    columns = [name for name in ("shot", "yaw", "remark", "counts") if dice.random() < 0.6]
    columns += [""] * (dice.random() < 0.1)  # an index without a name
    harmless = {dice.choice(names): cells for names, cells in HARMLESS.items() if dice.random() < 0.05}
    deciding = {name: cells for name, *cells in DECIDING + CONDITIONS if dice.random() < 0.02}
    # The rule for two groups of numbers needs six shots that count.
    has_fast_yaw = "yaw" in columns and not ("counts" in columns or deciding) and count >= 6 and dice.random() < 0.3
    columns += [*harmless, *deciding, "velocity", "result"]
    dice.shuffle(columns)
    rows, velocities, complete, remarks, refused = [], list[float](), list[bool](), list[str](), False
    for number in range(1, count + 1):
        shown = round(dice.gauss(middle, 0.03 * middle) / UNITS[unit], decimals)
        perforated = (number % 2 == 0) if number < 3 else dice.random() < 0.5
        counts = number < 3 or "counts" not in columns or dice.random() < 0.8
        is_wanted = {name: number < 3 or dice.random() < 0.8 for name in deciding}
        is_yawed = has_fast_yaw and number > 2 and dice.random() < 0.15
        remark = dice.choice(locale.remarks if dice.random() < 0.95 else REJECTIONS) if dice.random() < 0.5 else ""
        mark = dice.choice(DOUBTED) if number > 2 and dice.random() < 0.005 else "{}"
        cells = {
            "shot": str(number),
            "velocity": written(shown, decimals, locale.decimal, group),
            "result": mark.format(words[perforated]),
            "yaw": written(dice.uniform(6.5, 9.0) if is_yawed else dice.uniform(0.0, 2.0), 1, locale.decimal, ""),
            "remark": remark,
            "counts": locale.yes[counts],
            "": str(number),
            **{name: dice.choice(values) for name, values in harmless.items()},
            **{name: values[0 if is_wanted[name] else 1] for name, values in deciding.items()},
        }
        rows.append([cells[name] for name in columns])
        if counts and all(is_wanted.values()):
            velocities.append(nan if is_yawed or mark != "{}" else shown * UNITS[unit])
            complete.append(perforated)
            remarks += [remark] * ("remark" in columns and remark in REJECTIONS)
        refused = refused or is_yawed or mark != "{}"
    lines = [[header.get(name, name) for name in columns], *rows]
    if dice.random() < 0.3:
        lines = [[locale.title], *([[]] if dice.random() < 0.5 else []), ["", "2026-03-02"], *lines]
    if dice.random() < 0.3:
        lines.insert(dice.randint(len(lines) - count + 1, len(lines)), [])
    lines += [[]] * dice.choice((0, 0, 2))
    width = len(columns) + dice.choice((0, 0, 0, 2))
    text = StringIO()
    end = dice.choice(("\r\n", "\r\n", "\n"))
    csv.writer(text, delimiter=separator, lineterminator=end).writerows(
        [[*line, *[""] * (width - len(line))] for line in lines]
    )
    declared = f"sep={separator}{end}" if dice.random() < 0.15 else ""
    encodings = ["utf-8-sig", "utf-8", "utf-16"] + ["cp1252"] * ("\u202f" not in text.getvalue())
    encoding = dice.choice(encodings)
    content = (declared + text.getvalue()).encode(encoding)
    assert encoding != "utf-16" or content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    where = {name: values[0] for name, values in deciding.items()}
    ignore = [*harmless, header["yaw"], header["remark"]]
    ignore += [f"column {place}" for place, name in enumerate(columns, 1) if not name]
    return Export(content, velocities, complete, where, ignore, header["remark"], remarks, refused)
