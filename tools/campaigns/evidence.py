"""Predict tests left out of the fits of the model error, also by simpler rules, and fill docs/evidence/left-out.md.

    python -m tools.campaigns evidence

Of bare plates, one alloy at a time is left out of the fit and predicted; or the tests at one end of the range of a
property; of AD85, one series of tests.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr
from scipy.stats import t

from armour.analysis.variants import Bools, Floats
from armour.evidence.fit import CONSTRAINT, USUAL_MASS_RATIO, Fit, LotTests, mixture_of
from armour.evidence.mixture import Mixture
from armour.evidence.model_error import DOUBTED, MEAN_SCATTER_PERCENT
from armour.evidence.tests import FARTHEST_BARE, STRANGE
from armour.reporting.pictures.drawing import BLUE, PANEL, RULE, VERMILION, Picture, Sheet, drawn, points, saved
from tools.campaigns.verdict import verdict
from tools.evidence import (
    GROUPS,
    LAWS,
    ROOT,
    SERIES,
    Group,
    Plates,
    Tiles,
    fitted,
    fitted_law,
    matched_pairs,
    plates_of,
    tiles_of,
)
from tools.tables import table, write_tables

PAGE, PICTURE = ROOT / "docs" / "evidence" / "left-out.md", ROOT / "docs" / "images" / "evidence.png"
NAMES = {
    "cores_aluminium_tensile": "cores on aluminium",
    "cores_aluminium": "the same, tensile strength not given",
    "cores_steel": "cores on steel",
    "fragments_aluminium": "fragments on aluminium",
    "fragments_steel": "fragments on steel",
}
# Ends of the interval, the velocity that is stopped with 95 %, and the median.
CHANCES = np.array([0.025, 0.05, 0.5, 0.975])
# Parts of the tests at each end of the range of a property that are left out.
PARTS = {"15 %": 0.15, "third": 1.0 / 3.0}
ENDS = {"backing_thickness_ratio": ("thickness", ("15 %", "third")), "backing_strength_GPa": ("strength", ("15 %",))}
# Logarithm of the factor beyond the thicknesses tested up to which a probability of bare plates is known.
KNOWN = float(np.log(FARTHEST_BARE))
# Greatest difference of velocities from the measured limit, per cent; scatters of shots, per cent, and probabilities of
# stopping one that are stated.
AWAY, SCATTERS, STATED = 10, (1.0, 2.0, 4.0), (0.9, 0.95)
# Probabilities of stopping that are asked for.
ASKED = (0.95, 0.9, 0.8)
# The rules by which an armour is called stopped or perforated, and what is wrong by them.
RULES, SHARES = ("expected", "model"), ("stopped, perforates", "perforated, stops")
# Least tests of a band that is listed.
LEAST = 25
# Least share of the tests of a group that must lie within their 95 % intervals.
LEAST_PERCENT = 93.0
# Edges of the bands of the thickness over the diameter.
EDGES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0)


class Outcome(NamedTuple):
    """Of limits that were predicted: errors of the median, and whether they lie in the interval and above 95 %."""

    error: Floats
    within: Floats
    above: Floats
    half_width: Floats
    stated: Floats  # probabilities of more than the computed limit
    observed: Floats

    @classmethod
    def of(cls, errors: Floats, mixture: Mixture) -> "Outcome":
        """Return the outcome, given logarithms of ratios, (n,), and the distributions of the ratios."""
        low, stopped, middle, high = (np.log(mixture.quantile(np.full(len(errors), p))) for p in CHANCES)
        within = (low <= errors) & (errors <= high)
        shares = within.astype(float), (errors > stopped).astype(float)
        stated = mixture.probability_above(np.ones(len(errors)))
        return cls(errors - middle, *shares, 0.5 * (high - low), stated, (errors > 0.0).astype(float))

    def at(self, where: Bools) -> "Outcome":
        """Return the outcome of some of the limits."""
        return Outcome(*(column[where] for column in self))

    def means(self) -> Floats:
        """Return mean square, mean shares and half-width, and how far what is stated is from what is observed."""
        off = abs(self.stated.mean() - self.observed.mean())
        return np.array([np.mean(self.error**2), self.within.mean(), self.above.mean(), self.half_width.mean(), off])


def numbers(means: Floats) -> list[str]:
    """Return RMS, shares and half-width of a row, per cent."""
    square, *shares, _ = means
    return [f"{100.0 * square**0.5:.1f}", *(f"{100.0 * share:.0f}" for share in shares[:2]), f"{100.0 * shares[2]:.1f}"]


class Predicted(NamedTuple):
    """Tests that were left out, and what is predicted of them."""

    error: Floats  # logarithm of the measured over the computed limit, (n,)
    mixture: Mixture  # of this ratio, (1, n)

    def at(self, where: Bools) -> Outcome:
        """Return the outcome of some of the tests."""
        return Outcome.of(self.error, self.mixture).at(where)

    def row(self) -> list[str]:
        """Return the number of tests, RMS and coverages."""
        return [f"{len(self.error)}", *numbers(Outcome.of(*self).means())[:3]]


def joined(parts: Sequence[Outcome]) -> Outcome:
    """Return outcomes as one."""
    return Outcome(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def updated(fit: Fit, tests: Plates | Tiles, extra_deviation: float = 0.0) -> Fit:
    """Return the fit for the lot of own tests, whose limits were measured exactly."""
    nothing = np.zeros(len(tests.error))
    own = LotTests(tests.quantities, tests.error, nothing, nothing, np.arange(len(nothing)))
    return fit.of_lot(extra_deviation).given(own)


def ranges_of(plates: Plates) -> dict[str, tuple[float, float]]:
    """Return the ranges of tests beyond which the trend is doubted."""
    return {name: (plates.quantities[name].min(), plates.quantities[name].max()) for name in DOUBTED}


def left_out(group: Group, plates: Plates, parts: Sequence[Bools]) -> Predicted:
    """Predict each of some parts of the tests by a fit to the others."""
    found = []
    for out in parts:
        rest = plates.at(~out)
        found.append(mixture_of([fitted(group, rest)], plates.at(out).quantities, ranges_of(rest)))
    columns = (np.concatenate([mixture[place] for mixture in found], axis=1) for place in range(4))
    return Predicted(np.concatenate([plates.error[out] for out in parts]), Mixture._make([*columns, True, 1.0]))


def by_rule(group: Group, plates: Plates, *, covariates: bool) -> tuple[Group, Plates]:
    """Return tests whose computed limit is k sqrt(Y t D^2/m), and the group without covariates or with them."""
    of = plates.quantities
    # Y t D^2/m, with lengths over the diameter: the strength times the thickness over the mass, per cube of D.
    strength = of["backing_strength_GPa"] * 1e3 / CONSTRAINT
    error = np.log(plates.measured) - 0.5 * np.log(strength * of["backing_thickness_ratio"] / of["rod_mass_ratio"])
    prior = group.prior if covariates else None
    terms = group.terms if covariates else ("1",)
    return replace(group, terms=terms, prior=prior), plates._replace(error=error)


def study(name: str) -> tuple[Plates, Predicted, list[list[str]]]:
    """Return tests of a group in order, what is predicted of them alloy by alloy, and the rows of all methods."""
    group = GROUPS[name]
    plates = plates_of(group.kind, group.metal)
    # In the order in which the alloys are left out.
    plates = plates.at(np.argsort(plates.alloy, kind="stable"))
    parts = [plates.alloy == alloy for alloy in np.unique(plates.alloy)]
    found = left_out(group, plates, parts)
    rows = [[NAMES[name], "this model", *found.row()]]
    if name != "cores_aluminium":
        for words, covariates in (("k sqrt(Y t D²/m)", False), ("the same, with these terms", True)):
            rows.append([NAMES[name], words, *left_out(*by_rule(group, plates, covariates=covariates), parts).row()])
    return plates, found, rows


def bands(name: str, plates: Plates, found: Predicted) -> Iterator[list[str]]:
    """Give the coverage in each band of the thickness, and of each round, with enough tests."""
    which = np.digitize(plates.quantities["backing_thickness_ratio"], EDGES)
    names = ["below 1", *(f"{low:g} to {high:g}" for low, high in pairwise(EDGES)), f"{EDGES[-1]:g} up"]
    parts = [(f"t/D {names[band]}", which == band) for band in np.unique(which)]
    parts += [(fired, plates.round == fired) for fired in np.unique(plates.round)]
    for words, where in parts:
        if where.sum() >= LEAST and not where.all():
            some = found.at(where)
            shares = [some.within, some.above, some.stated, some.observed]
            yield [NAMES[name], words, f"{where.sum()}", *(f"{100.0 * share.mean():.0f}" for share in shares)]


def beyond_the_limit(name: str, found: Predicted) -> Iterator[list[str]]:
    """Give the tests that stop a velocity above the computed limit, of those stated to with a probability."""
    for probability in ASKED:
        least = np.log(found.mixture.quantile(np.full(len(found.error), 1.0 - probability)))
        some = least > 0.0
        if count := int(some.sum()):
            held = int((found.error >= least)[some].sum())
            yield [NAMES[name], f"{100.0 * probability:.0f}", f"{count}", f"{held}", f"{100.0 * held / count:.0f}"]


def called(name: str, found: Predicted) -> list[str]:
    """Give what a shot does at armours that are called stopped and perforated, at velocities near their limits.

    The rules are the expected limit and the limit by the model; the scatter of shots is that which is assumed.
    """
    # Logarithms of evenly spaced velocities over the measured limit; and the chance that a shot perforates.
    u = np.log1p(0.01 * np.linspace(-AWAY, AWAY, 401))
    perforates = ndtr(100.0 * u / MEAN_SCATTER_PERCENT)
    cells = []
    for limit in (found.mixture.locations[0], np.zeros_like(found.error)):
        stopped = u <= (limit - found.error)[:, None]
        chances = np.broadcast_to(perforates, stopped.shape)
        cells += [chances[stopped].mean(), 1.0 - chances[~stopped].mean()]
    return [NAMES[name], *(f"{100.0 * cell:.0f}" for cell in cells)]


def shots(name: str, found: Predicted) -> Iterator[list[str]]:
    """Give the shares of shots stopped at the velocities that are stated to be stopped with a probability."""
    limits = found.mixture.of_shots(0.01 * MEAN_SCATTER_PERCENT)
    for stated in STATED:
        velocities = np.log(limits.quantile(np.full(len(found.error), 1.0 - stated)))
        shares = (ndtr(100.0 * (found.error - velocities) / scatter).mean() for scatter in SCATTERS)
        yield [NAMES[name], f"{100.0 * stated:.0f}", *(f"{100.0 * share:.1f}" for share in shares)]


def ends(name: str) -> Iterator[list[str]]:
    """Give the coverage of the tests at the ends of a range that are left out."""
    group = GROUPS[name]
    plates = plates_of(group.kind, group.metal)
    for column, words, part in [(column, words, part) for column, (words, parts) in ENDS.items() for part in parts]:
        values = plates.quantities[column]
        low, high = np.quantile(values, (PARTS[part], 1.0 - PARTS[part]))
        for end, out in (("least", values <= low), ("greatest", values >= high)):
            if len(np.unique(plates.alloy[~out])) <= len(group.terms):
                continue
            found, rest = left_out(group, plates, [out]), values[~out]
            near = abs(np.log(values[out] / values[out].clip(rest.min(), rest.max()))) <= KNOWN
            known = f"{100.0 * found.at(near).above.mean():.0f}" if column == "backing_thickness_ratio" else ""
            yield [NAMES[name], f"{end} {words}, {part}", *found.row(), known]


def angles() -> Iterator[list[str]]:
    """Give by how much limits at an angle exceed the greatest at normal incidence of the same plate and round."""
    pairs = matched_pairs()
    for angle in sorted({angle for angle, _ in pairs}):
        more = [100.0 * (ratio - 1.0) for of_angle, ratio in pairs if of_angle == angle]
        yield [f"{angle:g}", f"{len(more)}", f"{min(more):+.0f}", f"{max(more):+.0f}"]


def wilkins(own: int, names: Collection[str] = LAWS) -> Outcome:
    """Predict the tests of each of Wilkins' series from all choices of some of them, the series left out of the fits.

    The fits are those of some laws of the flow stress, which have equal weights without own tests.
    """
    tiles, found = {name: tiles_of(law) for name, law in LAWS.items()}, []
    first = tiles["constant"]
    for number in range(3):
        left = {name: fitted_law(LAWS[name], tiles[name].at(number != SERIES))[0] for name in names}
        places = np.flatnonzero(number == SERIES)
        for some in map(np.array, combinations(places, own)):
            rest, fits_of = np.setdiff1d(places, some), [*left.values()]
            if own:
                fits_of = [updated(fit, tiles[name].at(some), STRANGE) for name, fit in left.items()]
            shifts = [first.error[rest] - tiles[name].error[rest] for name in names]
            mixture = mixture_of(fits_of, first.at(rest).quantities).times(np.exp(shifts))
            found.append(Outcome.of(first.error[rest], mixture))
    return joined(found)


def series() -> Iterator[list[str]]:
    """Give the methods on each series of Wilkins' tests, and on all, with the series left out of the fits."""
    for method, names in {"three laws": [*LAWS], **{f"{name} alone": [name] for name in LAWS}}.items():
        found = wilkins(0, names)
        parts = {f"{number + 1}": np.equal(SERIES, number) for number in range(3 if len(names) > 1 else 0)}
        for words, where in {**parts, "all": SERIES >= 0}.items():
            some = found.at(where)
            rms, _, _, half_width = numbers(some.means())
            yield [method, words, f"{where.sum()}", rms, half_width, f"{some.within.sum():.0f}"]


def picture(sheet: Sheet) -> Picture:
    """Draw the tests of cores on aluminium over the thickness, with the median and the interval of the model."""
    group = GROUPS["cores_aluminium"]
    plates = plates_of(group.kind, group.metal)
    of, fit = plates.quantities, fitted(group, plates)
    x = np.linspace(of["backing_thickness_ratio"].min(), of["backing_thickness_ratio"].max(), 121)
    usual = {"backing_strength_GPa": 0.3 * CONSTRAINT, "rod_mass_ratio": USUAL_MASS_RATIO, "path_ratio": 1.0}
    q = {name: np.full(len(x), value) for name, value in usual.items()} | {"backing_thickness_ratio": x}
    location, scale, _ = fit.predicted(q, {})
    half = t.ppf(0.975, fit.degrees_of_freedom) * scale
    measured = (100.0 * np.expm1(plates.error)).tolist()
    low, middle, high = (100.0 * np.expm1(location + side * half) for side in (-1.0, 0.0, 1.0))
    shown = sheet.panels("Armour-piercing cores on aluminium", PANEL)
    [axes] = shown.axes
    words = "95 % interval, a new alloy and round, 300 MPa"
    axes.fill_between(x, low, high, color=BLUE, alpha=0.3, linewidth=0, label=words)
    points(axes, of["backing_thickness_ratio"], measured, filled=False, markersize=2.5, color=BLUE, label="516 tests")
    axes.plot(x, middle, color=VERMILION, label="median, 300 MPa")
    axes.axhline(0.0, linestyle=":", **RULE)
    axes.set(xlabel="thickness along the line of fire over core diameter", ylabel="measured less computed limit, %")
    return shown


def main() -> int:
    """Write the page."""
    studies = {name: study(name) for name in NAMES}
    predicted = {name: found for name, (_, found, _) in studies.items()}
    with_all = [name for name in NAMES if name != "cores_aluminium"]
    rows = (
        [row for _, _, methods in studies.values() for row in methods],
        [row for name in with_all for row in bands(name, *studies[name][:2])],
        [row for name, found in predicted.items() for row in beyond_the_limit(name, found)],
        [called(name, found) for name, found in predicted.items()],
        [row for name, found in predicted.items() for row in shots(name, found)],
        [row for name in with_all[:-1] for row in ends(name)],  # there are too few of fragments on steel
        [*angles()],
        [*series()],
    )
    numbers = "tests", "RMS, %", "within 95", "95 true"
    heads = (
        ("tests of", "method", *numbers),
        ("tests of", "band or round", "tests", "within 95", "95 true", "stated", "observed"),
        ("tests of", "probability, %", "tests", "stopped", "stopped, %"),
        ("tests of", *(f"{rule}: {share}" for rule in RULES for share in SHARES)),
        ("tests of", "stated, %", *(f"scatter {scatter:g} %" for scatter in SCATTERS)),
        ("tests of", "left out", *numbers, "95 true, known"),
        ("angle, degrees", "limits", "least, % more", "greatest, % more"),
        ("method", "series", "tests", "RMS, %", "half-width, %", "within 95"),
    )
    write_tables(PAGE, *map(table, heads, rows))
    within = [100.0 * Outcome.of(*found).within.mean() for found in predicted.values()]
    PICTURE.write_bytes(saved(drawn(picture, Sheet()).figure, ".png"))
    text = f"95 % intervals contain {min(within):.0f} to {max(within):.0f} % of the tests of alloys left out, by group"
    return verdict(text, right=min(within) >= LEAST_PERCENT)
