"""The page of designs: what it holds, and in Chromium what it answers."""

import json
import random
import re
import shlex
from base64 import b64decode, b64encode
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit, confidence
from armour.design.catalogue import catalogue_of
from armour.design.check import check_of
from armour.design.optimise import DesignResult, optimise
from armour.errors import InputError
from armour.reporting import design_page as module
from armour.reporting.by_result import in_a_line
from armour.reporting.design_page import design_page
from armour.reporting.formats import TEMPLATES
from armour.reporting.views.design import chance_text, found_in_a_line, limit_text, limit_words, verdict_word
from armour.scenario.scenario import Scenario
from tests.helpers.browser import CHROMIUM, Question, browsed, needs_chromium
from tests.helpers.cases import scenario, shipped_scenario
from tests.helpers.known import known

pytestmark = pytest.mark.slow

COMMAND = ("armour", "simulate", "catalogue")
TITLE = "</script><script>alert(1)</script> & <b>"


@cache
def offered() -> Scenario:
    return shipped_scenario("catalogue").replaced({"title": TITLE, "design.probability_of_stopping": 0.9})


@cache
def page() -> str:
    return design_page(offered(), COMMAND)


def data_of(content: str) -> dict[str, Any]:
    [text] = re.findall(r'<script type="application/json" id="data">(.*?)</script>', content, re.DOTALL)
    found: dict[str, Any] = json.loads(text)
    return found


def numbers_of(pair: dict[str, Any], threats: int) -> tuple[Any, Any]:
    """Limits, (ceramics, back plates, threats), and the velocities stopped with each probability."""
    shape = len(pair["ceramics"]), len(pair["backings"]), threats
    floats = np.frombuffer(b64decode(pair["floats"]), dtype="<f4").reshape(*shape, 3).astype(float)
    differences = np.frombuffer(b64decode(pair["differences"]), dtype="<u2").reshape(*shape, -1)
    above = np.concatenate([np.zeros((*shape, 1)), np.cumsum(differences, axis=-1) * pair["step"]], axis=-1)
    return floats[..., 0], floats[..., 1:2] + above


def test_every_thickness_on_offer_is_a_node():
    pairs = data_of(page())["pairs"]
    for pair, offer in zip(pairs, catalogue_of(offered()).offers, strict=True):
        for nodes, places, layer in zip((pair["ceramics"], pair["backings"]), pair["offered"], offer[:2], strict=True):
            assert [nodes[place] for place in places] == list(layer.thicknesses())


def test_a_node_has_the_limit_and_the_probabilities_of_its_design():
    threats = data_of(page())["threats"]
    pair = data_of(page())["pairs"][0]
    limits, stopped = numbers_of(pair, len(threats))
    i, j = pair["offered"][0][7], pair["offered"][1][2]
    for t in range(len(threats)):
        armour = (
            catalogue_of(offered())
            .against(0, t)
            .replaced(
                {"armour.ceramic_thickness_mm": pair["ceramics"][i], "armour.backing_thickness_mm": pair["backings"][j]}
            )
        )
        assert limits[i, j, t] == pytest.approx(ballistic_limit(armour).ballistic_limit_m_s, abs=0.02)
        probabilities = data_of(page())["probabilities"]
        for q in (0, probabilities.index(0.9), len(probabilities) - 1):
            sure = confidence(armour.replaced({"impact.velocity_m_s": float(stopped[i, j, t, q])}))
            stated = min(probabilities[q], known(sure.model_error).greatest_probability)
            assert sure.probability_of_stopping == pytest.approx(stated, abs=2e-4)


def test_a_page_is_the_same_each_time():
    grid = {"min": 6.0, "max": 8.0, "step": 1.0}
    few = scenario(optimise={"ceramic_thickness_mm": grid, "backing_thickness_mm": grid})
    assert design_page(few, COMMAND) == design_page(few, COMMAND)


def test_a_page_is_small_and_asks_for_nothing():
    assert len(page().encode()) < 1_500_000
    assert (TEMPLATES / "map.js").stat().st_size <= 53_500
    assert "http" not in page().replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")
    assert page().count("</script>") == 2
    scripts, styles = (re.findall(rf"<{tag}>(.*?)</{tag}>", page(), re.DOTALL) for tag in ("script", "style"))
    for text, policy in ((scripts[0], "script-src"), (styles[0], "style-src")):
        assert f"{policy} 'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'" in page()


def test_more_than_a_page_can_hold_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "MOST_DESIGNS", 500)
    with pytest.raises(InputError, match="must offer at most 500 designs times threats to draw them on a page"):
        design_page(offered(), COMMAND)


def test_a_page_that_would_be_large_has_fewer_nodes_between_those_on_offer(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "MOST_DESIGNS", 620)
    pairs = data_of(design_page(offered(), COMMAND))["pairs"]
    assert all(pair["coarser"] for pair in pairs)
    assert [len(pair["ceramics"]) for pair in pairs] == [len(pair["offered"][0]) for pair in pairs]
    assert not data_of(page())["pairs"][0]["coarser"]


def test_what_is_not_shown_is_said():
    grid = {"min": 6.0, "max": 8.0, "step": 1.0}
    several = shipped_scenario("reliable").replaced(
        {"design.minimise": "thickness_mm", "optimise": {"ceramic_thickness_mm": grid, "backing_thickness_mm": grid}}
    )
    notes = " ".join(data_of(page())["notes"] + data_of(design_page(several, COMMAND))["notes"])
    for words in (
        "Pareto front",
        "greatest thickness",
        "least thickness; this page",
        "distributions of the inputs are not",
    ):
        assert words in notes


# --- in Chromium ------------------------------------------------------------------------------------------------------


CASES = [
    ([850.0, 830.0], None),
    ([850.0, 830.0], 90),
    ([800.0, 900.0], 80),
    ([700.0, 650.0], 95),
    ([1200.0, 900.0], 50.5),
]
LIGHTEST = f"""const cases = {json.dumps(CASES)};
return cases.map(([velocities, probability]) => {{
  state.velocities = velocities;
  state.probability = probability;
  return DATA.pairs.map(pair => {{ const {{ k }} = answer(pair); return [headline(pair, k), sentence(pair, k)]; }});
}});"""
VELOCITIES = np.linspace(600.0, 1300.0, 36).tolist()
CHANCES = f"""const pair = DATA.pairs[0];
  const chance = (k, v) => {{ state.velocities = [v]; return below(scored(pair, k, 0)); }};
  return pair.onOffer.map(k => [...thicknesses(pair, k), ...{VELOCITIES}.map(v => chance(k, v))]);"""
KEYS = """const press = (key, more) => $("map").dispatchEvent(new KeyboardEvent("keydown", { key, ...more }));
  press("Home"); press("ArrowUp"); press("ArrowLeft", { shiftKey: true }); press("Enter");
  return { wide: document.documentElement.scrollWidth - innerWidth, pins: state.pins.length, title: document.title,
    notes: $("notes").textContent, headline: $("headline").textContent,
    verdict: $("verdict").textContent, design: $("design").textContent,
    commands: document.querySelectorAll("code").length };"""
COPIES = """const pair = DATA.pairs[state.pair], words = command(pair, answer(pair).k), copies = [];
  for (const refuses of [false, true]) {
    let written = null;
    const writeText = async text => { if (refuses) throw new Error("refused"); written = text; };
    Object.defineProperty(navigator, "clipboard", { value: { writeText }, configurable: true });
    const button = document.querySelector("#table button");
    button.focus();
    button.click();
    await new Promise(after => setTimeout(after, 50));
    copies.push([button.textContent, written ?? String(getSelection()).trim(), document.activeElement === button]);
  }
  return [words, copies];"""
VERDICTS = """return %s.map(([n, ceramic, backing, velocities, probability]) => {
  Object.assign(state, { velocities, probability });
  const pair = DATA.pairs[n], [i, j] = [pair.ceramics.indexOf(ceramic), pair.backings.indexOf(backing)];
  const k = i * pair.backings.length + j;
  return [headline(pair, k), sentence(pair, k)];
});"""
SHOWN = """const pair = DATA.pairs[0];
  return pair.onOffer.map(k => {
    state.cursor = k;
    drawDesign(pair, k);
    const rows = [...$("design").querySelectorAll(".row")];
    return [...thicknesses(pair, k), rows.map(row => [...row.children].map(each => each.textContent))];
  });"""
METALS = {"design.backing": [{"material": name, "thickness_mm": [8.0]} for name in ("6061-T6", "7075-T6")]}
SENTENCES: list[tuple[dict[str, Any], str]] = [
    ({"armour.ceramic": "SiC"}, "stopped by the model: 7.62 mm AP at 850 m/s, limit "),
    ({"armour.ceramic": "SiC", "design.probability_of_stopping": 0.9}, "not known: no test of SiC on metal is known; "),
    ({"armour.ceramic": "B4C"}, "not known: the flow stress of its ceramic has 1 source, at least 2 required"),
    (
        {"threat": [{"projectile": "7.62 mm APM2", "velocity_m_s": 830.0, "obliquity_deg": 30.0, "margin_m_s": 20.0}]},
        "stopped by the model: 7.62 mm APM2 at 830 m/s, 30° obliquity, limit ",
    ),
    ({"impact.velocity_m_s": 3000.0}, "FAILS: stops a shot of 7.62 mm AP at 3000 m/s with below 1 % (none required)"),
    ({"impact.velocity_m_s": 3000.0, "uncertainty.model.included": False}, "perforated by the model: 7.62 mm AP at"),
    ({"design.areal_density_max_kg_m2": 20.0}, "FAILS: areal density 37.1 kg/m², at most 20 kg/m² allowed"),
    ({"optimise.backing_thickness_mm": {"min": 8.0, "max": 8.0, "step": 1.0}}, " on 8 mm 5083-H3, "),
    (
        {
            "design.probability_of_stopping": 0.6,
            "uncertainty.impact.velocity_m_s": {"distribution": "normal", "standard_deviation": 5.0},
        },
        " % (60 % required), with exact inputs",
    ),
    ({"design.probability_of_stopping": 0.95}, " so far from the tests (95 % required)"),
    ({"impact.velocity_m_s": 700.0}, "expected to stop: a shot of 7.62 mm AP at 700 m/s, with "),
    (METALS, "Do not compare metals of different strength: the model exaggerates it."),
]


@cache
def thin() -> Scenario:
    """Few designs, some with thin back plates, where the laws of the evidence are far apart."""
    return shipped_scenario("paper/optimum_7.62mm_AP").replaced(
        {
            "uncertainty.model.included": True,
            "optimise.ceramic_thickness_mm": {"min": 8.0, "max": 14.0, "step": 3.0},
            "optimise.backing_thickness_mm": {"min": 4.0, "max": 8.0, "step": 2.0},
        }
    )


ODD = 'it\'s a "rod" of $HOME'


def odd_page() -> str:
    """The page of a projectile whose name a shell would not leave as it is."""
    projectile = {
        "penetrator_diameter_mm": 6.5,
        "penetrator_mass_g": 5.46,
        "density_kg_m3": 7850.0,
        "flow_stress_GPa": 2.35,
    }
    range_mm = {"min": 6.0, "max": 9.0, "step": 1.0}
    own = scenario(
        library={"projectile": {ODD: projectile}},
        threat=[{"projectile": ODD, "velocity_m_s": 800.0}],
        optimise={"ceramic_thickness_mm": range_mm, "backing_thickness_mm": range_mm},
    )
    return design_page(own, ("armour", "simulate", "a file.toml"), ["ballistic_limit.velocity_max_m_s=2500"])


def page_with(changes: dict[str, Any]) -> str:
    grid = {"min": 6.0, "max": 12.0, "step": 2.0}
    first: dict[str, Any] = {"optimise.ceramic_thickness_mm": grid, "optimise.backing_thickness_mm": grid}
    included = {"uncertainty.model.included": True}
    return design_page(shipped_scenario("paper/optimum_7.62mm_AP").replaced({**first, **included, **changes}), COMMAND)


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the pages answer in Chromium, by the name of the question."""
    if CHROMIUM is None:
        pytest.skip("needs Chromium")
    questions = {
        "lightest": Question(page(), LIGHTEST),
        "chances": Question(design_page(thin(), COMMAND), CHANCES),
        "keys, 390": Question(page(), KEYS, 390),
        "keys, 1280": Question(page(), KEYS),
        "shown": Question(page(), SHOWN),
        "copies": Question(page(), COPIES),
        "catalogue": Question(page(), VERDICTS % json.dumps(drawn_at_random(offered(), 1))),
        "mixed": Question(design_page(mixed(), COMMAND), VERDICTS % json.dumps(drawn_at_random(mixed(), 1))),
        "odd": Question(odd_page(), "return command(DATA.pairs[0], DATA.pairs[0].onOffer[5]);"),
    }
    show = 'return ["headline", "verdict", "beside", "notes"].map(each => $(each).textContent).join(" ");'
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "PAGE_NODES", module.PAGE_NODES[-1:])  # they are on designs on offer
        questions |= {words: Question(page_with(changes), show) for changes, words in SENTENCES}
    return dict(zip(questions, browsed(tmp_path_factory.mktemp("pages"), list(questions.values())), strict=True))


def asked(of: Scenario, velocities: list[float], percent: float | None) -> Scenario:
    """A scenario with other velocities of its threats and another required probability."""
    threats = [
        {**threat.model_dump(exclude_unset=True), "velocity_m_s": v}
        for threat, v in zip(of.threats(), velocities, strict=True)
    ]
    required = None if percent is None else percent / 100.0
    return of.replaced({"threat": threats, "design.probability_of_stopping": required})


def offer_alone(of: Scenario, pair: int, **thicknesses: float) -> Scenario:
    """A scenario that offers one of its pairs of materials, with thicknesses of "ceramic" and "backing", if given."""
    layers = dict(zip(("ceramic", "backing"), catalogue_of(of).offers[pair][:2], strict=True))
    given = {role: {"thickness_mm": [value]} for role, value in thicknesses.items()}
    return of.replaced(
        {
            f"design.{role}": [layer.model_dump(exclude_unset=True) | given.get(role, {})]
            for role, layer in layers.items()
        }
    )


def headline_of(result: DesignResult) -> str:
    """What `optimise` says of the best design, without its cost, which the page leaves out."""
    return found_in_a_line(result).partition(", cost")[0]


def test_the_lightest_designs_are_those_that_optimise_finds(told):
    for (velocities, percent), lines in zip(CASES, told["lightest"], strict=True):
        of = asked(offered(), velocities, percent)
        results = [optimise(offer_alone(of, pair)) for pair in range(len(catalogue_of(of).offers))]
        assert lines == [[headline_of(result), in_a_line(result.shown.check)] for result in results]


def test_probabilities_between_the_nodes_are_right(told):
    found = np.array(told["chances"])
    catalogue = catalogue_of(thin())
    candidates = catalogue.candidates(0, found[:, 0], found[:, 1])
    rows = catalogue.against_each(candidates)
    of_shots = rows.shot_distributions(rows.limits_anywhere())
    for n, (chances, greatest) in enumerate(zip(found[:, 2:], rows.errors.greatest, strict=True)):
        sure = np.minimum(of_shots.one(n).probability_above(VELOCITIES), greatest)
        within = (sure >= 0.01) & (sure <= 0.99)
        assert within.sum() > 5
        assert chances[within] == pytest.approx(sure[within], abs=0.002)
        assert chances[~within] == pytest.approx(sure[~within], abs=0.0101)


# The number with which a value on the page begins, but for what is far from the tests.
LEADING = re.compile(r"^\d+(?= (?:%|m/s)$)")


def test_numbers_are_those_of_check(told):
    """A probability or a speed may differ by a step where the error of the page decides about the rounding."""
    differing = 0
    for ceramic_mm, backing_mm, rows in told["shown"][::3]:
        thicknesses = {"armour.ceramic_thickness_mm": ceramic_mm, "armour.backing_thickness_mm": backing_mm}
        expected = []
        for threat in check_of(offered().replaced(thicknesses), changes=False, needed=False).threats:
            expected += [["stops", chance_text(threat)], ["limit expected", f"{limit_text(threat)} m/s"]]
            _, _, safe = limit_words(threat).partition("; ")
            expected += [re.findall(r"(.* up to) (.*)", safe)[0]] if safe else []
            expected += [["far from the tests", ", ".join(threat.far_from_tests)]] if threat.far_from_tests else []
        for (name, value), (name_on_page, on_page) in zip(expected, rows, strict=True):
            assert (name_on_page, LEADING.sub("", on_page)) == (name, LEADING.sub("", value))
            steps = [float(number[0]) for number in map(LEADING.match, (value, on_page)) if number]
            assert not steps or abs(steps[0] - steps[1]) <= 1.0
            differing += value != on_page
    assert differing <= 3


@cache
def mixed() -> Scenario:
    """A catalogue with bare plates, a ceramic without tests and one of a single source, and a limit of weight."""
    ceramics = {"AD85": [0.0, 3.0, 5.0, 7.0, 9.0, 12.0, 18.0], "SiC": [4.0, 8.0, 12.0], "B4C": [0.0, 4.0, 8.0, 12.0]}
    metals = {"6061-T6": [3.0, 6.0, 9.0, 14.0], "RHA Class 1": [3.0, 6.0, 9.0]}
    layers = {
        role: [{"material": name, "thickness_mm": values} for name, values in materials.items()]
        for role, materials in {"ceramic": ceramics, "backing": metals}.items()
    }
    own = {"projectile": "7.62 mm AP", "velocity_m_s": 750.0, "probability_of_perforation": 0.1}
    threats = [own, {"projectile": "7.62 mm APM2", "velocity_m_s": 700.0, "name": "M2"}]
    return scenario(threat=threats, design={"areal_density_max_kg_m2": 60.0, **layers})


def drawn_at_random(of: Scenario, seed: int) -> list[tuple[int, float, float, list[float], float | None]]:
    """Pair, thicknesses, velocities and required probability, %, of designs of a catalogue."""
    chosen, catalogue, cases = random.Random(seed), catalogue_of(of), []
    for _ in range(30):
        pair = chosen.randrange(len(catalogue.offers))
        ceramic_mm, backing_mm = (chosen.choice(layer.thicknesses()) for layer in catalogue.offers[pair][:2])
        velocities = [round(velocity * chosen.uniform(0.65, 1.35), 1) for velocity in catalogue.velocities_m_s]
        cases.append((pair, ceramic_mm, backing_mm, velocities, chosen.choice([None, None, 60.0, 90.0, 95.0])))
    return cases


@pytest.mark.parametrize(("name", "of"), [("catalogue", offered), ("mixed", mixed)])
def test_page_check_and_optimise_give_one_verdict(told, name: str, of: Any):
    found = set()
    for (pair, ceramic_mm, backing_mm, velocities, percent), lines in zip(
        drawn_at_random(of(), 1), told[name], strict=True
    ):
        alone = offer_alone(asked(of(), velocities, percent), pair, ceramic=ceramic_mm, backing=backing_mm)
        result = optimise(alone)
        verdict = check_of(result.shown.scenario, changes=False, needed=False).verdict
        assert lines[1].partition(" against every")[0].partition(":")[0] == verdict_word(verdict)
        assert (lines[0], verdict) == (headline_of(result), result.shown.check.verdict)
        found.add(verdict)
    assert len(found) >= 3


@pytest.mark.parametrize("width", [390, 1280])
def test_it_works_by_keyboard_and_keeps_within_its_width(told, width: int):
    found = told[f"keys, {width}"]
    assert found["wide"] <= 0
    assert found["pins"] == 1
    assert TITLE in found["notes"]
    assert found["headline"].startswith("lightest: ")
    assert found["verdict"].startswith("passes against every threat: stops a shot of ")
    assert "limit expected" in found["design"]
    assert found["commands"] == 3


def test_a_command_is_copied_or_selected_where_the_browser_refuses(told):
    words, copies = told["copies"]
    assert copies == [["Copied", words, True], ["Selected", words, True]]


def test_commands_are_of_the_designs_and_need_no_care_in_a_shell(told):
    assert shlex.split(told["odd"]) == [
        *("armour", "simulate", "a file.toml", "--set", "ballistic_limit.velocity_max_m_s=2500"),
        *("--set", "armour.ceramic_thickness_mm=7", "--set", "armour.backing_thickness_mm=7"),
        *("--set", f"impact.projectile={json.dumps(ODD)}"),
    ]


@pytest.mark.parametrize("words", [words for _, words in SENTENCES])
def test_the_sentences_are_those_of_the_case(told, words: str):
    assert words in told[words]


@needs_chromium
def test_a_page_names_what_the_model_cannot_do_for_the_design_it_names(tmp_path: Path):
    rod = {"penetrator_diameter_mm": 10.0, "penetrator_mass_g": 138.2, "density_kg_m3": 17600.0, "flow_stress_GPa": 1.9}
    bare = scenario(
        "rod",
        None,
        "RHA Class 1",
        0.0,
        10.0,
        velocity=1500.0,
        library={"projectile": {"rod": rod}},
        design={"backing": [{"material": "RHA Class 1", "thickness_mm": [8.0, 10.0]}]},
    )
    metals = [{"material": name, "thickness_mm": [40.0]} for name in ("6061-T6", "7075-T6")]
    tiles = {"ceramic": [{"material": "SiC", "thickness_mm": [3.0, 12.0]}], "backing": metals}
    thin, thick = (
        scenario("12.7 mm APM2", "SiC", "6061-T6", 3.0, 40.0, velocity=v, design=tiles) for v in (400.0, 1100.0)
    )
    show = 'return $("verdict").textContent + " " + $("beside").textContent;'
    found = browsed(tmp_path, [Question(design_page(of, COMMAND), show) for of in (bare, thin, thick)])
    assert found[0].startswith("not known: ")
    assert "twice" not in found[0]
    assert "2.0 times the hydrodynamic depth; the limit is too low." in found[0]
    assert ["Do not compare metals of different strength" in words for words in found] == [False, True, True]
