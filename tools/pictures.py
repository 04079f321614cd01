"""Write the charts of docs/index.md and docs/learn that no command draws, from what the program computes.

    python -m tools.pictures

They take the colour of the text around them: on a page, that of the page; as a picture, that of the reader's system.
The drawings and vignettes beside them in docs/images have no program.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np

import armour

IMAGES = Path(__file__).parents[1] / "docs" / "images"
SCENARIO = armour.load_scenario("wilkins")
QUESTION = armour.load_scenario("panel").replaced({"design.probability_of_stopping": 0.95})
CERAMIC, PLATE, ROD, BLUE, RED = "#d9c48c", "#9fb3c4", "#5f6b7a", "#3b8fc4", "#d55e00"
LEFT, RIGHT = 'text-anchor="start"', 'text-anchor="end"'
BOLD, SMALL = 'font-weight="bold"', 'font-size="13"'
# As large on a wide screen as the text around it.
NARROW = 'style="max-width: 24rem" '
HEAD = """<svg {style}xmlns="http://www.w3.org/2000/svg" id="{name}" viewBox="0 0 {width} {height}" \
fill="currentColor" font-family="sans-serif" font-size="14" text-anchor="middle" stroke-linecap="round">
<style>@media (prefers-color-scheme: dark) {{ #{name} {{ color: #ddd; }} }}</style>
<defs><marker id="{name}-tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" \
orient="auto-start-reverse"><path d="M0,0 8,4 0,8z"/></marker></defs>
"""


def svg(name: str, width: int, height: int, parts: Sequence[str], style: str = "") -> str:
    """Return a picture of some parts."""
    return "\n".join([HEAD.format(name=name, width=width, height=height, style=style), *parts, "</svg>\n"])


def box(x: float, y: float, width: float, height: float, fill: str) -> str:
    """Return a rectangle."""
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}" stroke="currentColor"/>'


def line(x1: float, y1: float, x2: float, y2: float, more: str = "") -> str:
    """Return a line, or an arrow."""
    return f'<path d="M{x1},{y1}L{x2},{y2}" stroke="currentColor" {more}/>'


def text(x: float, y: float, words: str, more: str = "") -> str:
    """Return words in their place."""
    return f'<text x="{x}" y="{y}" {more}>{words}</text>'


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


def answer() -> str:
    """Return the probability that the lightest armour stops the round, over its velocity, and the armour."""
    design: Any = armour.optimise(QUESTION).best
    limit: Any = armour.ballistic_limit(design.scenario)
    velocity = QUESTION.impact.velocity_m_s
    velocities = np.arange(600.0, 1201.0, 10.0)
    stopped = limit.model_error.probability_of_stopping(limit.ballistic_limit_m_s, velocities)
    probability = 100 * design.check.threats[0].probability_of_stopping
    x, y = scale(600, 62, 0.61), scale(0, 320, -1.4)
    ceramic, plate = 4 * design.ceramic_thickness_mm, 4 * design.backing_thickness_mm
    parts = [
        text(62, 24, "7.62 mm AP", LEFT),
        text(62, 42, f"at {velocity:.0f} m/s", LEFT),
        box(62, 60, 100, 26, ROD),
        line(172, 73, 206, 73, 'stroke-width="2" marker-end="url(#home-answer-tip)"'),
        box(214, 12, ceramic, 122, CERAMIC),
        box(214 + ceramic, 12, plate, 122, PLATE),
        text(306, 34, f"{design.ceramic_thickness_mm:g} mm AD85", LEFT),
        text(306, 52, f"{design.backing_thickness_mm:g} mm 6061-T6", LEFT),
        text(306, 70, f"{design.areal_density_kg_m2:.1f} kg/m²", LEFT),
        text(306, 104, f"stops {int(probability)} %", f'{LEFT} {BOLD} font-size="18"'),
        text(8, 160, "probability that a shot is stopped", f"{LEFT} {SMALL}"),
    ]
    below = velocities <= velocity
    area = [(x(600), y(0)), *((x(v), y(100 * p)) for v, p in zip(velocities[below], stopped[below], strict=True))]
    corners = " ".join(f"{across},{up}" for across, up in [*area, (x(velocity), y(0))])
    parts.append(f'<polygon points="{corners}" fill="{BLUE}" opacity="0.2"/>')
    parts += panel(x, y, range(600, 1201, 100), (0, 50, 100), " %")
    parts += [
        curve([x(v) for v in velocities], [y(100 * p) for p in stopped], BLUE),
        line(x(velocity), y(0), x(velocity), y(probability), f'stroke-width="2" style="color: {RED}"'),
        dot(x(velocity), y(probability), RED),
        text(x(velocity) + 8, y(24), f"{velocity:.0f} m/s", f"{LEFT} {SMALL}"),
        text(245, 360, "impact velocity, m/s"),
    ]
    return svg("home-answer", 460, 366, parts)


def thickness() -> str:
    """Return the areal density of the thinnest ceramic for each back plate that stops the round by the model."""
    frontier = armour.optimise(SCENARIO.replaced({"uncertainty.model.included": False})).frontier
    lightest = min(design.areal_density_kg_m2 for design in frontier)
    near = [d.backing_thickness_mm for d in frontier if d.areal_density_kg_m2 <= 1.03 * lightest]
    x, y = scale(2, 52, 24.5), scale(46, 236, -13.5)
    left, width = x(near[0]), x(near[-1]) - x(near[0])
    area = f'<rect x="{left}" y="36" width="{width}" height="200" fill="{BLUE}" opacity="0.2"/>'
    parts = [area, *panel(x, y, range(2, 15, 2), range(46, 61, 2))]
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
    return svg("thickness", 370, 290, parts, NARROW)


def limits() -> str:
    """Return three meanings of a limit over the velocity: of the model, of its error, and of the scatter of shots."""
    limit: Any = armour.ballistic_limit(SCENARIO)
    velocities = np.arange(580.0, 881.0, 10.0)
    stopped = limit.model_error.probability_of_stopping(limit.ballistic_limit_m_s, velocities)
    fit: Any = armour.v50(armour.read_shots("tests/shots")).recommended
    scatter = NormalDist(fit.v50_m_s, fit.scale_m_s)
    titles = ("1. The model: one limit", "2. Its error: where the limit may lie", "3. One armour: shots scatter")
    parts = [text(8, 16, "probability of perforation", f"{LEFT} {SMALL}")]
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
    return svg("limits", 370, 530, parts, NARROW)


PICTURES = {"home-answer": answer, "thickness": thickness, "limits": limits}

if __name__ == "__main__":
    for name, drawing in PICTURES.items():
        (IMAGES / f"{name}.svg").write_text(drawing(), encoding="utf-8")
