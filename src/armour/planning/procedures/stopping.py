"""End of a firing by the interval of V50 that `armour v50` recommends."""

from armour.errors import NoAnswerError
from armour.planning.procedures.settings import ShotSettings
from armour.statistics.penalised_curve import fit_penalised
from armour.statistics.response_curve import FittedCurve
from armour.statistics.v50 import Shots


def recommended_fit(shots: Shots, confidence: float) -> FittedCurve | None:
    """Return the probit curve of the penalised likelihood; None where the shots have none."""
    partial, complete = shots.of(complete=False), shots.of(complete=True)
    if not partial or not complete:
        return None
    try:
        return fit_penalised(partial, complete, "probit", confidence)
    except NoAnswerError:
        return None


def narrow_enough(interval: tuple[float | None, float | None], settings: ShotSettings) -> str:
    """Return that an interval of V50 is as narrow as asked; "" if it is not."""
    low, high = interval
    if settings.half_width_m_s is None or low is None or high is None or 0.5 * (high - low) > settings.half_width_m_s:
        return ""
    return f"the interval of V50 is within ± {settings.half_width_m_s:g} m/s"


def stopped(shots: Shots, settings: ShotSettings) -> str:
    """Return why the firing ends; "" if it goes on."""
    fit = None if settings.half_width_m_s is None else recommended_fit(shots, settings.confidence)
    return "" if fit is None else narrow_enough(fit.v50_interval_m_s, settings)
