"""A published maximum-likelihood fit: [Dalal1989].

Thermal distress of O-rings in 23 flights, which textbooks fit by logit P = 15.0429 - 0.2322 T, deviance 20.315.
No shots, but the likelihood is the same, with the temperature turned round to make it rise.
"""

import pytest

from armour.statistics.curves import fit_curve

FLIGHTS = {False: (66, 69, 68, 67, 72, 73, 70, 78, 67, 67, 75, 70, 81, 76, 79, 76), True: (70, 57, 63, 70, 53, 75, 58)}


def test_the_published_curve():
    velocities = {distress: [700.0 - t for t in temperatures] for distress, temperatures in FLIGHTS.items()}
    fit = fit_curve(velocities[False], velocities[True], "logit")
    assert fit is not None
    assert 1.0 / fit.scale_m_s == pytest.approx(0.2322, abs=5e-5)
    assert (700.0 - fit.v50_m_s) / fit.scale_m_s == pytest.approx(15.0429, abs=1e-3)
    assert -2.0 * fit.log_likelihood == pytest.approx(20.315, abs=1e-3)
