"""What is computed, in words: the armour and the rounds, the first line of every answer, chart and report."""

from collections.abc import Mapping, Sequence

from armour.scenario.inputs import BACKING, CERAMIC, NAMES, VELOCITY
from armour.scenario.schema import ArmourSection, Impact, Threat

# Values by key of a scenario, in place of its own: names that are listed, and numbers that are left out.
Varied = Mapping[str, Sequence[object]]
# Where the velocity is searched for.
ANY_VELOCITY: Varied = {VELOCITY: ()}
# Names and threats that are listed.
MAX_LISTED = 3


def rounds(impact: Impact, varied: Varied, threats: Sequence[Threat]) -> str:
    """Return round and velocity, such as "7.62 mm AP at 800 m/s", of threats or, without any, of an impact."""
    if len(threats) > MAX_LISTED:
        return f"{len(threats)} threats"
    if threats:
        return " and ".join(f"{threat.projectile} at {threat.velocity_m_s:g} m/s" for threat in threats)
    names = _names(varied.get(NAMES["projectile"], [impact.projectile]), "different rounds")
    return names if VELOCITY in varied else f"{names} at {impact.velocity_m_s:g} m/s"


def layers(armour: ArmourSection, varied: Varied) -> str:
    """Return thicknesses and names of the layers, such as "6.35 mm AD85 on 6.35 mm 6061-T6"."""
    ceramic = _names(varied.get(NAMES["ceramic"], [armour.ceramic]), "ceramic")
    plate = _names(varied.get(NAMES["backing"], [armour.backing]), "metal")
    if BACKING not in varied:
        plate = f"{round(armour.backing_thickness_mm, 3):g} mm {plate}"
    if CERAMIC not in varied:
        ceramic = f"{round(armour.ceramic_thickness_mm, 3):g} mm {ceramic}" if armour.ceramic_thickness_mm else ""
    return f"{ceramic} on {plate}" if ceramic else plate


def _names(names: Sequence[object], unknown: str) -> str:
    """Return different names in words, without that of no ceramic; of an empty list, what they name."""
    found = [str(name) for name in dict.fromkeys(names) if name]
    if len(found) > MAX_LISTED:
        found = [*found[:MAX_LISTED], f"{len(found) - MAX_LISTED} more"]
    *first, last = found or ["" if names else unknown]
    return f"{', '.join(first)} or {last}" if first else last


def heading(computed: str, title: str) -> list[str]:
    """Return the first lines of an output: what is computed and, where it has other words, the scenario's title."""
    return [computed, *(f"scenario: {line}" for line in (title_beside(computed, title),) if line)]


def title_beside(computed: str, title: str) -> str:
    """Return the scenario's title, unless its words, in their order, are among those of what is computed."""
    words = iter(computed.split())
    return "" if all(word in words for word in title.replace(",", "").split()) else title
