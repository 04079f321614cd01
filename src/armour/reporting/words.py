"""Sentences on the probability of stopping, the model error, and the flow stress of a ceramic without tests."""

from collections.abc import Iterable, Sequence
from math import ceil, floor, inf

from armour.analysis.ballistic_limit import ConfidenceResult, NeededFlowStress
from armour.design.check import CheckedThreat
from armour.design.requirements import Requirement
from armour.errors import Note, counted, joined
from armour.evidence.caveats import no_metal
from armour.evidence.model_error import INTERLAYER, ModelError, TestsHere
from armour.reporting.table import Column, Table, VerdictLine, beside, interval, number, percent
from armour.scenario.library import named_threats
from armour.scenario.scenario import Scenario
from armour.scenario.schema import OBJECTIVES

# Caveat of a probability where the model error is not known.
SAMPLED_ALONE = "a probability from the given distributions alone takes the model as exact"


def chance(probability: float | None, error: ModelError | None = None, required: float | None = None) -> str:
    """Format a probability of stopping, such as "73 %"; it is rounded down, so as never to overstate it.

    It is as exact as the one `required`, and reads "at least" if `error` says that the limit may be higher.
    """
    if probability is None:
        return "not known"
    decimals = 0 if required is None else len(f"{100.0 * required:.8g}".partition(".")[2])
    percents = f"{rounded_down(100.0 * probability, decimals):.{decimals}f} %"
    if error is not None and error.at_least and 0.01 <= probability <= 0.99:
        return f"at least {percents}"
    if probability < 0.01:
        return "below 1 %"
    return "above 99 %" if probability > 0.99 and not decimals else percents


def rounded_down(number: float, decimals: int = 0) -> float:
    """Round a positive number down, except where only floating-point error keeps it below the next step."""
    return floor(round(number * 10**decimals, 9)) / 10**decimals


def sampled_percents(stopping: float, ends: tuple[float, float]) -> tuple[float, float, float]:
    """Return a sampled probability of stopping and the ends of its interval, %; only the upper end is rounded up."""
    value, low, above = (rounded_down(100.0 * part, 1) for part in (stopping, ends[0], 1.0 - ends[1]))
    return value, low, 100.0 - above


def requirement_words(requirement: Requirement) -> str:
    """Return what an armour has and what is required, such as "areal density 41.5 kg/m², at most 20 kg/m² allowed"."""
    if requirement.quantity == "backing_density_kg_m3":
        return no_metal(requirement.found or 0.0)
    if requirement.quantity == "interlayers":
        return INTERLAYER
    if requirement.quantity == "flow_stress_sources":
        sources = f"{counted(int(requirement.found or 0), 'source')}, at least {requirement.required:g} required"
        return f"the flow stress of its ceramic has {sources} (its own, and flow_stress_sources_GPa around it)"
    quantity, found, most = requirement.quantity, requirement.found, requirement.required
    unit = OBJECTIVES[quantity].unit
    text = "not known" if found is None else amount(quantity, found, most) + unit
    return f"{Column.of(quantity).label.removesuffix(unit)} {text}, at most {most:g}{unit} allowed"


def amount(quantity: str, value: float, most: float = inf) -> str:
    """Format the areal density, thickness or cost of an armour; rounding never brings it within the `most` allowed."""
    text = beside(value, most, 0 if quantity == "cost_per_m2" else 1, at_most=True)
    return text.removesuffix(".0") if quantity == "thickness_mm" else text


def said_of(notes: Iterable[Note], *kinds: str) -> list[str]:
    """Return the texts of notes that the answer itself must show, without repeats.

    `kinds` are values of `Note.said`, by default "caveat" and "too low".
    """
    kinds = kinds or ("caveat", "too low")
    return list(dict.fromkeys(note.text for note in notes if note.said in kinds))


def far_line(far: Sequence[object], against: str = "") -> list[Table | str]:
    """Return a line on what of an armour is far from the tests, none if nothing is.

    `far` has what lies outside what was tested, in words by `str`; `against` is "" or as " against M2 AP".
    """
    return [VerdictLine(f"far from the tests{against}: {', '.join(map(str, far))}", unsure=True)] if far else []


def threat_sources(scenario: Scenario | None) -> list[str]:
    """Return name, status and source of each threat of a scenario whose values in the library are unconfirmed."""
    names = dict.fromkeys(threat.threat for threat in scenario.threats()) if scenario else {}
    found = [(name, named_threats()[name]) for name in names if name]
    return [f"{name}: {threat.status}, {threat.source}" for name, threat in found if threat.status == "unconfirmed"]


def model_error_words(error: ModelError) -> str:
    """Return the model error and its source, where it is extrapolated, and any own tests of the same armour."""
    if error.ratio.logarithmic:
        low, median, high = (error.quantiles_percent[level] for level in ("0.025", "0.5", "0.975"))
        size = f"{number(median, '+.0f')} % ({interval((low, high), '+.0f')} %)"
    else:
        mean = f"{error.mean_percent:+.1f} % " if error.mean_percent else ""
        size = f"{mean}± {error.scale_percent:.1f} %"
    words = [f"model error: {size}, from {error.source}"]
    words += [f"at least that, as {error.at_least}"] if error.at_least else []
    words += [f"extrapolated from {', '.join(error.extrapolated)}"] if error.extrapolated else []
    return "; ".join([*words, *tested_here(error)])


def v50_notes(answer: ConfidenceResult | CheckedThreat, velocity_m_s: float) -> list[str]:
    """Return a line on how likely V50 exceeds the velocity of a round, and on the scatter of shots; none if unknown."""
    exceeds, error = answer.probability_v50_exceeds_velocity, answer.model_error
    if exceeds is None or error is None:
        return []
    scatter = f"shots scatter by {error.scatter_percent:.2g} % of V50 ({error.scatter_source})"
    return [f"V50 exceeds {velocity_m_s:g} m/s with {chance(exceeds)}; {scatter}"]


def tested_here(error: ModelError) -> list[str]:
    """Return what own tests of the same armour measured, if any, what the other own tests predict, and then doubts."""
    if (here := error.tests_here) is None:
        return []
    count, measured = len(here.limits_m_s), measured_here(here)
    others = {0: "without it", 1: "the other own test alone"}.get(here.others, f"the {here.others} others alone")
    predicted = f"about {here.median_m_s:.0f} ({interval(here.interval_m_s, '.0f')}) m/s"
    words = [f"{f'measured {measured}' if measured else 'tested'} here ({own_tests(here)})", f"{others}: {predicted}"]
    if here.out_of_line:
        words += ["out of line with the others: check it" if count == 1 else f"{here.out_of_line} out of line: check"]
    if count == 1 and not here.shots:
        words += ["rests on one test of this armour: a second V50 would settle it"]
    elif count > 1 and not here.confirmed:
        words += ["these tests do not agree"]
    return words


def measured_here(here: TestsHere) -> str:
    """Return the limits of the same armour that own tests measured, such as "703 ± 9 and 715 m/s"; "" without any."""
    measured = zip(here.limits_m_s, here.uncertainties_m_s, strict=True)
    limits = [f"{limit:.0f}{f' ± {deviation:.0f}' * bool(deviation)}" for limit, deviation in measured]
    return f"{joined(limits)} m/s" if limits else ""


def own_tests(here: TestsHere) -> str:
    """Return the numbers of own tests and shots at the same armour, such as "1 own test and 3 shots"."""
    numbers = (len(here.limits_m_s), "own test"), (here.shots, "shot")
    return " and ".join(counted(number, noun) for number, noun in numbers if number)


def needed_flow_stress(needed: NeededFlowStress, *, likely: bool = True) -> str:
    """Return in words the least flow stress with which a ceramic without tests stops a threat, and what sources give.

    It is the one by the model and, if `likely`, also the one for a probability, with the error seen on AD85.
    """
    sources = " to ".join(f"{each:g}" for each in needed.sources_GPa)
    given = f"sources give {sources}" if sources else "no source"
    if needed.needed_GPa is None:
        return f"no flow stress of {needed.ceramic} up to 100 GPa is enough; {given}"
    words, enough = f"{rounded_up(needed.needed_GPa)} GPa by the model", needed.needed_for_probability_GPa
    if likely:
        more = "no value" if enough is None else f"{rounded_up(enough)} GPa"
        words += f", {more} for {percent(needed.probability)}"
    return f"a flow stress of {needed.ceramic} of {words}; {given}"


def rounded_up(number: float) -> str:
    """Format a positive number rounded up to a tenth; floating-point error above a tenth is ignored."""
    return f"{ceil(10.0 * number - 1e-9) / 10.0:g}"


def basis_notes(answer: ConfidenceResult | CheckedThreat) -> list[str]:
    """Return lines on what a probability of stopping rests on: the model error, or the distributions of inputs alone.

    If it is unknown, return why, and the flow stress that the ceramic needs.
    """
    if answer.probability_of_stopping is not None:
        error = answer.model_error
        return [SAMPLED_ALONE if error is None else model_error_words(error)]
    notes = [f"how likely a shot is stopped is not known: {answer.reason}"]
    if (at_normal := answer.probability_at_normal_incidence) is not None:
        notes.append(f"at 0°: {chance(at_normal)}, and bare plates stop cores at least as well")
    if (needed := answer.flow_stress) is not None:
        notes.append(f"needs {needed_flow_stress(needed)}")
        limits = " to ".join(f"{limit:.0f}" for limit in needed.limits_m_s)
        notes += [f"ballistic limit with the flow stress of the sources: {limits} m/s"] if limits else []
    return notes
