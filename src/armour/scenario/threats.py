"""Threats by name: round, velocity and angle, as standards list them."""

from functools import cache
from typing import Literal

from armour.files import read_toml, shipped
from armour.scenario.sections import Section, validated

# Keys of [impact] and [[threat]] that the name of a threat gives.
THREAT_KEYS = ("projectile", "velocity_m_s", "obliquity_deg")


class NamedThreat(Section):
    """A threat of a standard."""

    standard: str
    level: str
    round: str
    projectile: str
    velocity_m_s: float
    tolerance_m_s: float | None = None
    """By which the velocity of a shot may differ."""
    obliquity_deg: float | None = None
    status: Literal["confirmed", "unconfirmed"]
    source: str

    def values(self) -> dict[str, object]:
        """Return the values that the threat gives in [impact] or [[threat]], by key."""
        return self.model_dump(include=set(THREAT_KEYS), exclude_none=True)


class _File(Section):
    threat: dict[str, NamedThreat]


@cache
def named_threats() -> dict[str, NamedThreat]:
    """Return the shipped threats by name."""
    return validated(_File, read_toml(shipped("configs") / "threats.toml"), "").threat
