"""Write the pictures of docs/learn from what the program computes: three moments of an impact, and two charts."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from statistics import NormalDist
from typing import Any

import numpy as np

import armour
from armour.core.equations import crack_velocity, sheared_diameter
from tools.drawings import CERAMIC, HEAD, IMAGES, PLATE, ROD, box, line, lip, text

SCENARIO = armour.load_scenario("wilkins")
# Pixels per millimetre; places of both faces and of the axis, and ends of the armour; width of a drawing.
SCALE, FRONT, BACK, AXIS, TOP, BOTTOM = 5.5, 158.0, 227.9, 150.0, 36.0, 264.0
WIDTH = 370
BLUE, RED, BROWN = "#3b8fc4", "#d55e00", "#6d5c2c"
LEFT, RIGHT = 'text-anchor="start"', 'text-anchor="end"'
BOLD, SMALL = 'font-weight="bold"', 'font-size="13"'


def head(name: str, height: int) -> str:
    """Return the beginning of a drawing, whose text is as large on a wide screen as that around it."""
    return HEAD.format(name=name, width=WIDTH, height=height).replace("<svg ", '<svg style="max-width: 24rem" ', 1)


def leader(x1: float, y1: float, x2: float, y2: float) -> str:
    """Return a line from words to what they name: dark in the armour, which is light in the dark, too."""
    (left, up), (right, down) = sorted(((x1, y1), (x2, y2)))
    cuts = [left, *(cut for cut in (FRONT, BACK) if left < cut < right), right]
    points = [(round(cut, 1), round(up + (down - up) * (cut - left) / (right - left), 1)) for cut in cuts]
    parts = []
    for start, end in pairwise(points):
        part, inside = line(*start, *end), FRONT <= start[0] < BACK
        parts.append(part.replace("currentColor", "#222") if inside else part)
    return "\n".join(parts)


def caption(x: float, y: float, lines: Sequence[str], side: str = "") -> str:
    """Return words in several lines."""
    return "\n".join(text(x, y + 16 * place, words, f"{side} {SMALL}".strip()) for place, words in enumerate(lines))


def moment(name: str, velocity: float, time_us: float, words: Sequence[str]) -> str:
    """Return a cross-section of the armour at a time, to the scale of the model, with words."""
    scenario = SCENARIO.replaced({"impact.velocity_m_s": velocity})
    history = armour.simulate(scenario, history=True).history
    assert history is not None
    index = int(np.abs(np.array(history.time_us) - time_us).argmin())
    depth, length, bulge = (
        SCALE * part[index] for part in (history.depth_mm, history.length_mm, history.bulge_height_mm)
    )
    p = scenario.core_armour()
    diameter, ceramic, plate, base = (
        1e3 * SCALE * part for part in (p.D0, p.Hc0, p.Hb, sheared_diameter(p.shear_law, p.D0, p.Hc0))
    )
    joint, back, tip = FRONT + ceramic, FRONT + ceramic + plate, FRONT + depth
    low = AXIS - diameter / 2
    # The crack runs from the back face to the penetrator; the conoid is as wide as the penetrator in front.
    cracked = min(ceramic - depth, SCALE * 1e-3 * crack_velocity(p.Ec, p.rho_c) * time_us)
    cracked = ceramic if cracked + depth >= ceramic else cracked
    start, narrow = joint - cracked, diameter / 2 + (base - diameter) / 2 * (1 - cracked / ceramic)
    cone = f"M{start:.1f},{AXIS - narrow:.1f} {joint:.1f},{AXIS - base / 2:.1f}V{AXIS + base / 2:.1f}"
    cone += f"L{start:.1f},{AXIS + narrow:.1f}z"
    parts = [
        head(name, 300),
        text(joint - 5, 24, "ceramic", f"{RIGHT} {SMALL}"),
        text(joint + 5, 24, "back plate", f"{LEFT} {SMALL}"),
        box(joint, TOP, round(plate, 1), BOTTOM - TOP, PLATE),
        box(FRONT, TOP, round(ceramic, 1), BOTTOM - TOP, CERAMIC),
        f'<path d="{cone}" fill="url(#{name}-cracks)" stroke="{BROWN}"/>',
    ]
    if depth > ceramic:
        parts.append(box(round(tip, 1), low, round(back + bulge - tip, 1), diameter, PLATE))
    if history.penetration_velocity_m_s[index] < history.velocity_m_s[index]:
        parts += [lip(tip, AXIS + side * diameter / 2, side) for side in (-1, 1)]
    parts.append(box(round(tip - length, 1), low, round(length, 1), diameter, ROD))
    return "\n".join([*parts, *words, "</svg>\n"])


def dwell() -> str:
    """Return the penetrator on the face of the ceramic, before the ceramic has cracked."""
    words = [
        text(60, 110, "penetrator", SMALL),
        caption(62, 215, ("eroded steel", "flows aside")),
        leader(104, 210, 140, 187),
        caption(246, 215, ("cracks run from", "the back face"), LEFT),
        leader(243, 213, 180, 190),
        text(180, 290, "590 m/s, after 3 µs"),
    ]
    return moment("dwell", 590.0, 3.0, words)


def erosion() -> str:
    """Return the eroding penetrator in the fragmented ceramic of the conoid."""
    tip = 'marker-end="url(#erosion-ink)" stroke-width="2"'
    words = [
        *(line(195, y, 222, y, tip).replace("currentColor", "#222") for y in (80, 115, 150, 185, 220)),
        text(60, 110, "penetrator", SMALL),
        caption(60, 215, ("eroded steel", "flows back")),
        leader(102, 210, 148, 190),
        caption(246, 100, ("conoid of frag-", "mented ceramic"), LEFT),
        leader(243, 100, 185, 104),
        caption(246, 180, ("its base loads", "a wide area of", "the back plate"), LEFT),
        text(180, 290, "800 m/s, after 12 µs"),
    ]
    return moment("erosion", 800.0, 12.0, words)


def plug() -> str:
    """Return the rigid penetrator that pushes a plug out of the back plate."""
    tip = 'marker-end="url(#plug-tip)" stroke-width="2"'
    words = [
        caption(78, 110, ("the rest of the", "penetrator is rigid")),
        line(250, 150, 278, 150, tip),
        caption(252, 108, ("plug, sheared", "out of the plate"), LEFT),
        leader(249, 117, 240, 140),
        caption(252, 200, ("bulge: how far it", "has moved out"), LEFT),
        text(180, 290, "800 m/s, after 39 µs: perforated"),
    ]
    return moment("plug", 800.0, 38.85, words)


Place = Callable[[float], float]


def scale(start: float, place: float, factor: float) -> Place:
    """Return where the values of an axis are, in pixels."""
    return lambda value: round(place + factor * (value - start), 1)


def panel(
    x: Place, y: Place, x_ticks: Sequence[float], y_ticks: Sequence[float], unit: str = "", numbers: bool = True
) -> list[str]:
    """Return the axes of a chart with its ticks."""
    left, right, foot = x(x_ticks[0]), x(x_ticks[-1]), y(y_ticks[0])
    grid = 'stroke-opacity="0.25"'
    parts = [line(left, foot, right, foot)]
    for value in y_ticks:
        parts.append(line(left, y(value), right, y(value), grid))
        parts.append(text(left - 6, y(value) + 4, f"{value:g}{unit}", f"{RIGHT} {SMALL}"))
    for value in x_ticks:
        parts.append(line(x(value), foot, x(value), foot + 4))
        if numbers:
            parts.append(text(x(value), foot + 18, f"{value:g}", SMALL))
    return parts


def curve(xs: Sequence[float], ys: Sequence[float], colour: str, more: str = "") -> str:
    """Return a curve through points."""
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(xs, ys, strict=True))
    return f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2.5" {more}/>'


def dot(x: float, y: float, colour: str) -> str:
    """Return a point."""
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{colour}" stroke="currentColor"/>'


def thickness() -> str:
    """Return the areal density of the thinnest ceramic for each back plate that stops the round by the model."""
    frontier = armour.optimise(SCENARIO.replaced({"uncertainty.model.included": False})).frontier
    lightest = min(design.areal_density_kg_m2 for design in frontier)
    near = [d.backing_thickness_mm for d in frontier if d.areal_density_kg_m2 <= 1.03 * lightest]
    x, y = scale(2, 52, 24.5), scale(46, 236, -13.5)
    left, width = x(near[0]), x(near[-1]) - x(near[0])
    area = f'<rect x="{left}" y="36" width="{width}" height="200" fill="{BLUE}" opacity="0.2"/>'
    parts = [head("thickness", 290), area]
    parts += panel(x, y, range(2, 15, 2), range(46, 61, 2))
    plates = [design.backing_thickness_mm for design in frontier]
    weights = [design.areal_density_kg_m2 for design in frontier]
    parts.append(curve([x(mm) for mm in plates], [y(kg) for kg in weights], BLUE))
    for plate, up, side in ((2.0, 10, LEFT), (6.0, 32, ""), (14.0, 10, RIGHT)):
        design = next(design for design in frontier if design.backing_thickness_mm == plate)
        place = x(plate), y(design.areal_density_kg_m2)
        parts.append(dot(*place, BLUE))
        words = f"{design.ceramic_thickness_mm:g} mm ceramic"
        parts.append(text(place[0], place[1] - up, words, f"{side} {SMALL}"))
    parts.append(text((x(near[0]) + x(near[-1])) / 2, y(52.5), "within 3 %", SMALL))
    parts += [text(8, 20, "areal density, kg/m²", LEFT), text(200, 280, "back plate, mm")]
    return "\n".join([*parts, "</svg>\n"])


def limits() -> str:
    """Return three meanings of a limit over the velocity: of the model, of its error, and of the scatter of shots."""
    limit: Any = armour.ballistic_limit(SCENARIO)
    velocities = np.arange(580.0, 881.0, 10.0)
    stopped = limit.model_error.probability_of_stopping(limit.ballistic_limit_m_s, velocities)
    fit: Any = armour.v50(armour.read_shots("tests/shots")).recommended
    scatter = NormalDist(fit.v50_m_s, fit.scale_m_s)
    titles = ("1. The model: one limit", "2. Its error: where the limit may lie", "3. One armour: shots scatter")
    parts = [head("limits", 530), text(8, 16, "probability of perforation", f"{LEFT} {SMALL}")]
    x = scale(580, 56, 0.98)
    places: list[Place] = []
    for row, (title, foot) in enumerate(zip(titles, (156, 300, 480), strict=True)):
        places.append(scale(0, foot, -1))
        parts += [text(8, foot - 116, title, f"{LEFT} {BOLD}")]
        parts += panel(x, places[-1], range(580, 881, 60), (0, 50, 100), " %", numbers=row == 2)
    step, error, shots = places
    at = limit.ballistic_limit_m_s
    parts += [
        curve([x(580), x(at), x(at), x(880)], [step(0), step(0), step(100), step(100)], BLUE),
        text(x(at) + 8, step(62), f"ballistic limit {at:.0f} m/s", f"{LEFT} {SMALL}"),
        curve([x(v) for v in velocities], [error(100 * (1 - part)) for part in stopped], BLUE),
    ]
    low, high = limit.interval_m_s
    parts += [
        f'<path d="M{x(low):.1f},{error(-14)}H{x(high):.1f}" stroke="{RED}" stroke-width="4"/>',
        text((x(low) + x(high)) / 2, error(-34), f"95 % interval {low:.0f} to {high:.0f} m/s", SMALL),
        dot(x(703.0), error(-14), RED),
        text(x(754), error(30), "measured 703 m/s", f"{LEFT} {SMALL}"),
        line(x(752), error(30), x(708), error(-8)),
    ]
    curve_x = np.arange(580.0, 881.0, 4.0)
    parts.append(curve([x(v) for v in curve_x], [shots(100 * scatter.cdf(v)) for v in curve_x], BLUE))
    named = (
        ("V05", fit.v05_m_s, 5, RIGHT, -10),
        ("V50", fit.v50_m_s, 50, RIGHT, -10),
        ("V95", fit.v95_m_s, 95, LEFT, 10),
    )
    for name, velocity, percent, side, shift in named:
        parts.append(dot(x(velocity), shots(percent), BLUE))
        down = 16 if percent == 95 else -6
        parts.append(text(x(velocity) + shift, shots(percent) + down, f"{name} {velocity:.0f} m/s", f"{side} {SMALL}"))
    parts.append(text(204, 522, "impact velocity, m/s"))
    return "\n".join([*parts, "</svg>\n"])


if __name__ == "__main__":
    for drawing in (dwell, erosion, plug, thickness, limits):
        (IMAGES / f"{drawing.__name__}.svg").write_text(drawing(), encoding="utf-8")
