"""Random armours with random requirements, the verdict of a plain rule on each, and the ways by which one reads it."""

import contextlib
import csv
import json
import re
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import armour
from armour.analysis.samples import probability_of_perforation
from armour.reporting.by_result import by_result, draw, in_a_line
from armour.reporting.design_page import design_page
from armour.reporting.pictures.drawing import Sheet
from armour.reporting.views.design import check_junit
from armour.scenario.scenario import Scenario
from tests.helpers.browser import Question, browsed
from tests.helpers.cases import scenario
from tests.helpers.commands import invoke
from tests.helpers.known import known

CERAMICS = ["AD85", "AD85", "AD99.5", "B4C", "lot", None]
PLACES = ["front", "behind", "between"]
METALS = ["6061-T6", "5083-H3", "AA7039-T64", "HHA Class 1"]
# One back plate of seven is no metal.
LAMINATE = {"UHMWPE": {"density_kg_m3": 980.0, "static_yield_strength_MPa": 900.0}}
ROUNDS = ["7.62 mm AP", "7.62 mm APM2", "7.62 mm B32"]
DISTRIBUTIONS = {"ceramic": {"flow_stress_GPa": {"distribution": "normal", "standard_deviation_percent": 4.0}}}


@cache
def library() -> dict[str, Any]:
    """A laminate, and a lot of alumina with own tests."""
    of = scenario(ceramic="AD99.5")
    tests = {"armour.ceramic_thickness_mm": [6.0, 8.0], "ballistic_limit_m_s": [760.0, 860.0]}
    fitted = armour.calibrate(armour.read_tests(tests, of), of, "ceramic.flow_stress_GPa")
    evidence = known(fitted.evidence)
    strength = {"value": evidence["calibrated"]["ceramic_strength_GPa"], "source": "own tests"}
    lot = {"based_on": "AD99.5", "flow_stress_GPa": strength, "evidence": evidence}
    return {"metal": LAMINATE, "ceramic": {"lot": lot}}


@cache
def case(seed: int) -> Scenario:
    """An armour, its threats near its limits, and what is required of it, in a catalogue of this armour alone."""
    random = Random(seed)
    ceramic, metal = random.choice(CERAMICS), random.choice(METALS)
    metal = "UHMWPE" if seed % 7 == 3 else metal
    hc = round(random.uniform(4.0, 12.0), 1) if ceramic else 0.0
    hb = round(random.uniform(5.0, 12.0) if ceramic else random.uniform(8.0, 40.0), 1)

    def velocity(projectile: str) -> float:
        own = scenario(projectile, ceramic, metal, hc, hb, library=library())
        limit = armour.confidence(own).ballistic_limit_m_s or 1000.0
        return round(limit * random.uniform(0.75, 1.08), random.choice([0, 1, 6]))

    threats: list[dict[str, Any]] = []
    for projectile in random.sample(ROUNDS, random.choice([1, 1, 2])):
        threat = {"projectile": projectile, "velocity_m_s": velocity(projectile)}
        threat |= {"margin_m_s": random.choice([20.0, 100.0])} if random.random() < 0.3 else {}
        threat |= {"probability_of_perforation": 0.2} if random.random() < 0.2 else {}
        threats.append(threat)
    design: dict[str, Any] = {"probability_of_stopping": random.choice([0.6, 0.9])} if random.random() < 0.6 else {}
    for key, most in (("thickness_max_mm", hc + hb), ("areal_density_max_kg_m2", 3.5 * hc + 2.75 * hb)):
        design |= {key: round(most * random.uniform(0.9, 1.3), 1)} if random.random() < 0.3 else {}
    costs = {"cost_per_kg": 20.0} if random.random() < 0.4 else {}
    design |= {"cost_max_per_m2": random.choice([300.0, 1500.0])} if costs and random.random() < 0.5 else {}
    design |= {"existing": "backing"} if random.random() < 0.2 else {}
    inert = {"name": "rubber", "place": random.choice(PLACES), "thickness_mm": 1.0, "areal_density_kg_m2": 1.2}
    inert |= {"cost_per_m2": 40.0} if costs else {}
    layers = {"ceramic": [{"material": ceramic, "thickness_mm": [hc], **costs}] if ceramic else []}
    layers["backing"] = [{"material": metal, "thickness_mm": [hb], **costs}]
    uncertain: dict[str, Any] = {}
    if ceramic and random.random() < 0.3:
        uncertain = {"uncertainty": {"samples": 1024, **DISTRIBUTIONS}}
    sections = {"threat": threats, "design": {**design, **layers}, "library": library(), **uncertain}
    of = scenario("7.62 mm AP", ceramic, metal, hc, hb, **sections)
    return of.replaced({"armour.layer": [inert]}) if random.random() < 0.3 else of


# The verdicts, from the worst.
WORDS = ("fails", "perforated by the model", "not known", "stopped by the model", "expected to stop", "passes")
HELD = WORDS[3:]


def against(of: Scenario, own: Scenario, bound: float | None, margin_m_s: float) -> str:
    """The verdict against one threat, the impact of `own`, by plain words."""
    sure, velocity = armour.confidence(own), own.impact.velocity_m_s
    at_margin = own.replaced({"impact.velocity_m_s": velocity + margin_m_s})
    limit, verdicts = sure.ballistic_limit_m_s or 10_000.0, []
    if sure.model_error is None:
        reaches = limit >= velocity + margin_m_s and armour.simulate(at_margin).outcome == "stopped"
        verdicts.append("passes" if reaches or not margin_m_s else "fails")
        unknown = ("not known", "fails") if bound is not None else ("stopped by the model", "perforated by the model")
        verdicts.append(unknown[0] if reaches else unknown[1])
        return min(verdicts, key=WORDS.index)
    error = known(sure.model_error)
    if margin_m_s:
        verdicts.append("passes" if known(sure.expected_limit_m_s) >= velocity + margin_m_s else "fails")
    most = 0.5 if bound is None else bound
    reached = "passes" if error.greatest_probability >= 1.0 - most else "not known"
    if bound is not None and of.distributions():
        odds = probability_of_perforation(own)
        verdicts.append(reached if odds.high <= bound else "fails" if odds.low > bound else "not known")
    else:
        by_tests = error.of_shots.probability_above(velocity / limit)
        verdicts.append(reached if by_tests >= 1.0 - most else "fails")
    if bound is None and "passes" in verdicts[-1:]:
        verdicts[-1] = "expected to stop"
    return min(verdicts, key=WORDS.index)


@cache
def rule(seed: int) -> str:
    """The verdict by plain words: each requirement for itself, from results of other functions."""
    of = case(seed)
    assert of.design is not None
    design, ceramic = of.design, of.entry_of("ceramic")
    is_between = any(part.place == "between" for part in of.armour.layer)
    holds = of.armour.backing != "UHMWPE" and not is_between and (ceramic is None or ceramic.name != "B4C")
    verdicts = []
    for threat in of.threat:
        bound = threat.probability_of_perforation
        if bound is None and design.probability_of_stopping is not None:
            bound = 1.0 - design.probability_of_stopping
        verdicts.append(against(of, of.against(threat), bound, threat.margin_m_s) if holds else "not known")
    core, plates = of.core_armour(), [(of.core_armour().rho_c, of.armour.ceramic_thickness_mm)]
    if design.existing is None:
        plates.append((core.rho_B, of.armour.backing_thickness_mm))
    mass, thickness = sum(density * mm / 1000.0 for density, mm in plates), sum(mm for _, mm in plates)
    cost = 20.0 * mass + sum(layer.cost_per_m2 for layer in of.armour.layer)
    mass += sum(layer.areal_density_kg_m2 for layer in of.armour.layer)
    thickness += sum(layer.thickness_mm for layer in of.armour.layer)
    for most, found in (
        (design.areal_density_max_kg_m2, mass),
        (design.thickness_max_mm, thickness),
        (design.cost_max_per_m2, cost),
    ):
        if most is not None:
            verdicts.append("passes" if found <= most * (1.0 + 1e-9) else "fails")
    return min(verdicts, key=WORDS.index)


@cache
def checked(seed: int) -> armour.CheckResult:
    return armour.check(case(seed))


def ways(seed: int, folder: Path) -> Iterator[tuple[str, bool]]:
    """Yield each way out but the page of designs, with whether it says what the rule says."""
    of, word, shown, is_held = case(seed), rule(seed), rule(seed).replace("fails", "FAILS"), rule(seed) in HELD
    result, found = checked(seed), armour.optimise(of)
    line = in_a_line(result)

    def has_line(text: str) -> bool:
        return line.lower() in " ".join(text.split()).lower()

    worst = min((row["verdict"] for row in result if row["verdict"]), key=WORDS.index)
    yield "Python", result.verdict == word == result.to_dict()["verdict"] == worst
    best = found.best and found.best.check
    yield "search", found.shown.check.verdict == word and best == (result if is_held else None)
    yield "repr", has_line(repr(result)) and line.partition(":")[0].removesuffix(" against every threat") == shown
    yield "title of the picture", has_line(by_result(draw, result)(result, Sheet()).title)
    suite = check_junit(result, of, 0.0, {}).attrib
    yield "JUnit", (suite["failures"] == "0") == is_held and (suite["skipped"] == "0" or word != "passes")
    with contextlib.chdir(folder):
        Path("s.toml").write_text(of.to_toml())
        files = ("--markdown", "check.md", "--junit", "check.xml", "--csv", "check.csv", "--force")
        done, as_json = invoke(["check", "s.toml", *files]), invoke(["check", "s.toml", "--json"])
        yield "terminal", has_line(done.stdout)
        yield "exit codes", {done.exit_code, as_json.exit_code} == {0 if is_held else 3}
        yield "JSON", json.loads(as_json.stdout)["verdict"] == word
        yield "Markdown", f"1 {shown}" in Path("check.md").read_text()
        yield "JUnit file", shown in Path("check.xml").read_text()
        lines = csv.DictReader(Path("check.csv").read_text().splitlines())
        yield "CSV", worst == min((row["verdict"] for row in lines if row["verdict"]), key=WORDS.index)
        Path("best.toml").unlink(missing_ok=True)
        done = invoke(["optimise", "s.toml", "--save", "best.toml"])
        yield "terminal of the search", has_line(done.stdout) and done.exit_code == (0 if is_held else 1)
        yield "design saved", Path("best.toml").exists() == (word in (*HELD, "not known"))
        for options in ((), ("--as-is",)):
            done = invoke(["report", "s.toml", "--force", *options])
            [said] = re.findall('<p class="verdict[^>]*>(.*?)</p>', Path("report.html").read_text())
            yield " ".join(("report", *options)), done.exit_code == 0 and said.lower().startswith(word)


def on_pages(seeds: Sequence[int], folder: Path) -> dict[int, bool]:
    """Whether the pages of designs say what the rule says: those that sample no distributions, as pages do not."""
    ask = "const pair = DATA.pairs[0]; return DATA.verdicts[judged(pair, answer(pair).k)];"
    asked = [seed for seed in seeds if not case(seed).distributions()]
    said = browsed(folder, [Question(design_page(case(seed), ("armour",)), ask) for seed in asked])
    return {seed: word.lower() == rule(seed) for seed, word in zip(asked, said, strict=True)}
