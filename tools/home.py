"""Write the pictures of the home page, docs/images/home-*.svg, from what the program computes."""

import csv
from statistics import NormalDist
from typing import Any

import numpy as np

import armour
from armour.files import shipped_tests
from tools.drawings import CERAMIC, HEAD, IMAGES, PLATE, ROD, box, line, lip, text
from tools.lessons import BLUE, BOLD, LEFT, RED, RIGHT, SMALL, curve, dot, panel, scale

QUESTION = armour.load_scenario("panel").replaced({"design.probability_of_stopping": 0.95})
WILKINS = armour.load_scenario("wilkins")
WORDS = 'font-size="12"'


def rows(table: str) -> list[dict[str, str]]:
    """Return the rows of a shipped table of tests."""
    with shipped_tests()[table].open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def card(name: str, title: str) -> list[str]:
    """Return the beginning of the picture of a card and what it shows."""
    return [HEAD.format(name=f"home-{name}", width=256, height=160), text(10, 18, title, f"{LEFT} {WORDS}")]


def ended(parts: list[str]) -> str:
    """Return a picture."""
    return "\n".join([*parts, "</svg>\n"])


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
    parts = [HEAD.format(name="home-answer", width=460, height=366)]
    parts += [
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
    return ended(parts)


def design() -> str:
    """Return the areal density over the back plate, for 50 and 90 %."""
    x, y = scale(4, 44, 24), scale(38, 126, -5)
    parts = [*card("design", "lightest for each back plate, kg/m²"), *panel(x, y, range(4, 13, 2), (40, 45, 50))]
    for confidence, words, colour in ((None, "50 %", BLUE), (0.9, "90 %", RED)):
        answer: Any = armour.optimise(QUESTION.replaced({"design.probability_of_stopping": confidence}))
        shown = [part for part in answer.frontier if 4 <= part.backing_thickness_mm <= 12]
        plates = [x(part.backing_thickness_mm) for part in shown]
        weights = [y(part.areal_density_kg_m2) for part in shown]
        parts += [
            curve(plates, weights, colour),
            dot(x(answer.best.backing_thickness_mm), y(answer.best.areal_density_kg_m2), colour),
            text(plates[-1] + 4, weights[-1] - 6, words, f"{RIGHT} {WORDS}"),
        ]
    return ended([*parts, text(139, 157, "back plate, mm", WORDS)])


def check() -> str:
    """Return the intervals of the limit as given and with changes, and the velocity."""
    threat = armour.check(WILKINS).threats[0]
    x = scale(550, 96, 0.42)
    changes = ("as given", "thinner tile", "thinner plate")
    limits: list[Any] = [threat, *threat.what_ifs[:2]]
    parts = card("check", "limit and its 95 % interval, m/s")
    for tick in range(600, 901, 100):
        parts += [line(x(tick), 126, x(tick), 130), text(x(tick), 144, f"{tick}", SMALL)]
    at = x(threat.velocity_m_s)
    parts.append(line(at, 30, at, 126, f'stroke-width="2" style="color: {RED}"'))
    for place, (words, limit) in enumerate(zip(changes, limits, strict=True)):
        height = 46 + 28 * place
        low, high = (x(end) for end in limit.interval_m_s)
        parts += [
            text(84, height + 4, words, f"{RIGHT} {WORDS}"),
            line(low, height, high, height, f'stroke-width="4" style="color: {BLUE}"'),
            dot(x(limit.expected_limit_m_s), height, BLUE),
        ]
    return ended([*parts, text(at - 5, 120, "the round", f"{RIGHT} {WORDS}")])


def impact() -> str:
    """Return the velocity of the penetrator over the time."""
    history: Any = armour.simulate(WILKINS, history=True).history
    x, y = scale(0, 44, 5), scale(0, 126, -0.115)
    times, velocities = np.array(history.time_us), np.array(history.velocity_m_s)
    parts = [*card("impact", "velocity of the penetrator, m/s"), *panel(x, y, range(0, 41, 10), (0, 400, 800))]
    parts.append(curve([x(time) for time in times], [y(value) for value in velocities], BLUE))
    return ended([*parts, text(144, 157, "time, µs", WORDS)])


def v50() -> str:
    """Return shots and the probability of perforation that is fitted to them."""
    fit: Any = armour.v50(armour.read_shots("tests/shots")).recommended
    x, y = scale(660, 44, 1.6), scale(0, 126, -0.9)
    parts = [*card("v50", "probability of perforation"), *panel(x, y, range(660, 781, 40), (0, 50, 100), "%")]
    law = NormalDist(fit.v50_m_s, fit.scale_m_s)
    speeds = np.arange(660.0, 781.0, 3.0)
    parts.append(curve([x(speed) for speed in speeds], [y(100 * law.cdf(speed)) for speed in speeds], BLUE))
    for shot in rows("tests/shots"):
        perforated = shot["result"] == "complete"
        parts.append(dot(x(float(shot["velocity_m_s"])), y(100 * perforated), RED if perforated else BLUE))
    return ended([*parts, text(140, 157, "impact velocity, m/s", WORDS)])


def learn() -> str:
    """Return a penetrator that erodes in fragmented ceramic."""
    parts = [
        HEAD.format(name="home-learn", width=256, height=160),
        box(176, 8, 36, 144, PLATE),
        box(140, 8, 36, 144, CERAMIC),
        '<path d="M140,64 176,14V146L140,96z" fill="url(#home-learn-cracks)" stroke="#6d5c2c"/>',
        lip(158, 64, -1),
        lip(158, 96, 1),
        box(40, 64, 118, 32, ROD),
        text(72, 52, "penetrator", WORDS),
        text(90, 134, "ceramic", WORDS),
        line(114, 130, 138, 130),
        text(234, 84, "plate", WORDS),
    ]
    return ended(parts)


def judge() -> str:
    """Return computed over measured limits."""
    x, y = scale(600, 52, 0.45), scale(600, 126, -0.22)
    ticks = range(600, 1001, 200)
    parts = [*card("judge", "computed limit, m/s"), *panel(x, y, ticks, ticks)]
    parts.append(line(x(600), y(600), x(1000), y(1000), 'stroke-dasharray="4 3"'))
    for test in rows("tests/wilkins"):
        measured = float(test.pop("ballistic_limit_m_s"))
        computed = armour.ballistic_limit(WILKINS.replaced({key: float(value) for key, value in test.items()}))
        parts.append(dot(x(measured), y(computed.ballistic_limit_m_s), BLUE))
    return ended([*parts, text(148, 157, "measured limit, m/s", WORDS)])


if __name__ == "__main__":
    for drawing in (answer, design, check, impact, v50, learn, judge):
        (IMAGES / f"home-{drawing.__name__}.svg").write_text(drawing(), encoding="utf-8")
