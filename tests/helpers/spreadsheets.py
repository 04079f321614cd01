"""Tables of shots as spreadsheets of several languages export them, at random."""

import codecs
import csv
from dataclasses import dataclass
from io import StringIO
from random import Random
from typing import NamedTuple


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


@dataclass
class Export:
    """A table as bytes, and the shots that it holds."""

    content: bytes
    velocities_m_s: list[float]
    complete: list[bool]


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
        "yaw": "Yaw (°)",
        "remark": dice.choice(("Remarks", "Bemerkung", "Remarque")),
        "counts": locale.counts,
    }
    optional = [name for name in ("shot", "yaw", "remark", "counts") if dice.random() < 0.6]
    columns = [*optional, "velocity", "result"]
    dice.shuffle(columns)
    rows, velocities, complete = [], list[float](), list[bool]()
    for number in range(1, count + 1):
        shown = round(dice.gauss(middle, 0.03 * middle) / UNITS[unit], decimals)
        perforated = (number % 2 == 0) if number < 3 else dice.random() < 0.5
        counts = number < 3 or "counts" not in columns or dice.random() < 0.8
        cells = {
            "shot": str(number),
            "velocity": written(shown, decimals, locale.decimal, group),
            "result": words[perforated],
            "yaw": written(dice.uniform(0.0, 5.0), 1, locale.decimal, ""),
            "remark": dice.choice(locale.remarks),
            "counts": locale.yes[counts],
        }
        rows.append([cells[name] for name in columns])
        if counts:
            velocities.append(shown * UNITS[unit])
            complete.append(perforated)
    lines = [[header[name] for name in columns], *rows]
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
    return Export(content, velocities, complete)
