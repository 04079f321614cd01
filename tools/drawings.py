"""Write the drawings of the documentation that no command draws: the geometry of the model, and its nine stages.

They take the colour of the text around them: on a page, that of the page; as a picture, that of the reader's system.
"""

from itertools import product
from pathlib import Path

IMAGES = Path(__file__).parents[1] / "docs" / "images"
CERAMIC, PLATE, ROD = "#d9c48c", "#9fb3c4", "#5f6b7a"
HEAD = """<svg xmlns="http://www.w3.org/2000/svg" id="{name}" viewBox="0 0 {width} {height}" fill="currentColor" \
font-family="sans-serif" font-size="14" text-anchor="middle" stroke-linecap="round">
<style>@media (prefers-color-scheme: dark) {{ #{name} {{ color: #ddd; }} }}</style>
<defs><marker id="{name}-tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" \
orient="auto-start-reverse"><path d="M0,0 8,4 0,8z"/></marker>
<marker id="{name}-ink" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" \
orient="auto-start-reverse"><path d="M0,0 8,4 0,8z" fill="#222"/></marker>
<pattern id="{name}-cracks" width="9" height="9" patternUnits="userSpaceOnUse" patternTransform="rotate(38)">\
<path d="M0,0H9M0,0V9" stroke="#6d5c2c" stroke-width="1.2"/></pattern></defs>
"""
# What rod and target do in the columns of the pictograms, and the names of the stages in these.
RODS, TARGETS = ("erodes", "rigid"), ("penetrates", "target carried")
STAGES = {
    "intact ceramic": ("i", "dwell", "ii.3", None),
    "fragmented ceramic": ("ii.1", "ii.2", "ii.3", "iii.5"),
    "plate": ("iii.1", "iii.2", "iii.3", "iii.4"),
}


def box(x: float, y: float, width: float, height: float, fill: str) -> str:
    """Return a rectangle."""
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}" stroke="currentColor"/>'


def line(x1: float, y1: float, x2: float, y2: float, more: str = "") -> str:
    """Return a line, or an arrow."""
    return f'<path d="M{x1},{y1}L{x2},{y2}" stroke="currentColor" {more}/>'


def text(x: float, y: float, words: str, more: str = "") -> str:
    """Return words in their place."""
    return f'<text x="{x}" y="{y}" {more}>{words}</text>'


def lip(x: float, y: float, side: int, size: float = 1.0) -> str:
    """Return eroded material that flows back from the edge of the tip of the penetrator, below it or above."""
    down = side * size
    curve = f"q0,{14 * down:g} {-24 * size:g},{16 * down:g} q{12 * size:g},{-5 * down:g} {10 * size:g},{-16 * down:g}z"
    return f'<path d="M{x:.1f},{y:.1f}{curve}" fill="{ROD}" stroke="currentColor"/>'


def symbol(letter: str, below: str = "") -> str:
    """Return a symbol in italics with its index."""
    index = f'<tspan font-size="10" dy="4">{below}</tspan>' if below else ""
    return f'<tspan font-style="italic">{letter}</tspan>{index}'


def geometry() -> str:
    """Return the geometry of the model with its symbols: the conoid to the model's scale, D = D0 + 4 Hc0."""
    both = 'marker-start="url(#geometry-tip)" marker-end="url(#geometry-tip)"'
    tip = 'marker-end="url(#geometry-tip)" stroke-width="2"'
    thin = 'stroke-dasharray="2 3"'
    front, joint, back, bulge, nose, middle = 190, 242, 292, 20, 214, 205
    edge = f"V{middle - 32}q0,8 8,8h{bulge - 16}q8,0 8,8v32q0,8 -8,8h{16 - bulge}q-8,0 -8,8V355"
    top, bottom = middle - 124, middle + 124
    parts = [
        HEAD.format(name="geometry", width=440, height=415),
        f'<path d="M{joint},55H{back}{edge}H{joint}z" fill="{PLATE}" stroke="currentColor"/>',
        f'<path d="M{front},55H{joint}{edge}H{front}z" fill="{CERAMIC}" stroke="currentColor"/>',
        f'<path d="M{front},{middle - 20} {joint},{top}{edge.replace("355", str(bottom))}L{front},{middle + 20}z" '
        'fill="url(#geometry-cracks)"/>',
        box(50, middle - 20, nose - 50, 40, ROD),
        text(216, 44, "ceramic"),
        text(290, 44, "back plate"),
        text(110, middle - 30, "rod"),
        # Velocities: of the rod, of its front, of the material ahead.
        f'<g color="#fff" fill="#fff">{line(66, middle + 6, 120, middle + 6, tip)}{text(92, middle, symbol("V"))}</g>',
        f'<g color="#222" fill="#222">{line(nose, middle, nose + 30, middle, tip.replace("tip", "ink"))}',
        text(nose + 15, middle - 8, symbol("U"), 'font-weight="bold"'),
        line(nose, 325, joint + bulge, 325, both.replace("tip", "ink")),
        text(nose + 40, 318, symbol("H", "c")),
        "</g>",
        line(back + bulge, middle, back + bulge + 34, middle, tip),
        text(back + bulge + 18, middle - 8, symbol("W")),
        # Dimensions.
        line(50, middle + 40, nose, middle + 40, both),
        text(120, middle + 58, symbol("L")),
        line(32, middle - 20, 32, middle + 20, both),
        text(14, middle + 5, symbol("D", "0")),
        line(nose, middle + 20, nose, 395, thin),
        *(line(x, 355, x, 395, thin) for x in (front, joint, back)),
        line(joint + bulge, middle + 24, joint + bulge, 330, thin),
        line(back, 325, back + bulge, 325, both),
        line(back + bulge, middle + 24, back + bulge, 330, thin),
        text(back + 10, 345, symbol("h")),
        line(front, 370, nose, 370, both),
        text(front - 14, 375, symbol("Z")),
        line(front, 392, joint, 392, both),
        text(front - 20, 397, symbol("H", "c0")),
        line(joint, 392, back, 392, both),
        text(back + 20, 397, symbol("H", "b")),
        *(line(joint, y, 425, y, thin) for y in (top, bottom)),
        line(418, top, 418, bottom, both),
        text(432, middle + 5, symbol("D")),
        *(text(362, y, words) for y, words in ((108, "conoid of"), (125, "fractured"), (142, "ceramic"))),
        line(326, 122, 238, 128),
        "</svg>\n",
    ]
    return "\n".join(parts)


def stage(x: float, y: float, medium: str, erodes: bool, penetrates: bool) -> str:
    """Return a pictogram of a stage, in a square of 100."""
    front, joint, back = x + 45, x + 65, x + 80
    tip = joint + 6 if medium == "plate" else front + 9 if penetrates else front
    moves = not penetrates and medium != "intact ceramic"
    bulge = 9 if moves else 4 if medium == "plate" else 0
    parts = [box(front, y + 8, joint - front, 78, CERAMIC)]
    if medium != "intact ceramic":
        parts.append(f'<rect x="{front}" y="{y + 8}" width="{joint - front}" height="78" fill="url(#stages-cracks)"/>')
    plate = f"M{joint},{y + 8}H{back}V{y + 36}h{bulge}v22h{-bulge}V{y + 86}H{joint}z"
    parts.append(f'<path d="{plate}" fill="{PLATE}" stroke="currentColor"/>')
    parts.append(box(x + 4, y + 38, tip - x - 4, 18, ROD))
    if erodes:
        parts += [lip(tip, y + 47 + side * 9, side, 0.6) for side in (-1, 1)]
    if moves:
        parts.append(line(back + 11, y + 47, back + 20, y + 47, 'stroke-width="2" marker-end="url(#stages-tip)"'))
    return "\n".join(parts)


def stages() -> str:
    """Return the nine stages of the model, and two that the paper does not name, as pictograms."""
    parts = [HEAD.format(name="stages", width=480, height=400)]
    for column, (rod, target) in enumerate(product(RODS, TARGETS)):
        x, erodes, penetrates = 45 + 108 * column, rod == "erodes", target == "penetrates"
        parts += [text(x + 48, 16, rod, 'font-size="12"'), text(x + 48, 31, target, 'font-size="12"')]
        for row, (medium, names) in enumerate(STAGES.items()):
            y = 40 + 120 * row
            if name := names[column]:
                parts += [stage(x, y, medium, erodes, penetrates), text(x + 48, y + 104, name, 'font-weight="bold"')]
    for row, medium in enumerate(STAGES):
        y = 40 + 120 * row + 47
        parts.append(text(24, y, medium, f'font-size="12" transform="rotate(-90 24 {y})"'))
    return "\n".join([*parts, "</svg>\n"])


if __name__ == "__main__":
    for drawing in (geometry, stages):
        (IMAGES / f"{drawing.__name__}.svg").write_text(drawing(), encoding="utf-8")
