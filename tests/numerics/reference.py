"""The model solved by another method: scipy's integrators on rates that follow the yielding rule at every instant.

None of the core's stages, events or steps is used.  Where a side starts or stops yielding, U is continuous and the
step control of the solver suffices; only changes of the medium and of held and moving are located.
"""

from math import pi, sqrt
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from armour.core.equations import CONOID, INTERFACE
from armour.core.state import Parameters

ARREST = 1.0  # m/s


class Reference:
    """One impact; the state vector is Z, L, V, W, h.

    ``longest`` is the longest step, in diameters travelled; short enough that no event comes and goes within one.
    """

    def __init__(
        self, a: Parameters, velocity: float, method: Any = "DOP853", rtol: float = 1e-11, longest: float = 0.005
    ) -> None:
        self.a = a
        self.method, self.rtol, self.longest = method, rtol, longest
        self.A0 = pi * a.D0**2 / 4
        self.medium = "intact" if a.Hc0 > 0 else "plate"
        self.joined = False
        self.Vs1 = velocity
        self.h_s = 0.0
        self.perforated = False
        start = np.array([0.0, a.L0, velocity, 0.0, 0.0])
        self.moving = self.medium == "plate" and self.drives(start)
        self.run(start)

    def strength(self, V: float, W: float) -> tuple[float, float]:
        a = self.a
        if self.medium == "plate":
            return a.YB, a.rho_B
        weakening = 1.0 if self.medium == "intact" else ((V - W) / self.Vs1) ** 2
        return a.Yc0 * weakening, a.rho_c

    def interface(self, V: float, W: float) -> tuple[float, bool, bool]:
        """Return U, whether the projectile yields and whether the target does."""
        a = self.a
        Y, rho = self.strength(V, W)
        target = a.Yp + a.rho_p * V * (V - W) > Y
        rod = Y + rho * V * (V - W) > a.Yp
        if not rod:
            return V, False, True
        if not target:
            return W, True, False
        # rho U^2 + (rho_p V - rho W) U + Y - Yp - rho_p V^2 = 0
        b, c = a.rho_p * V - rho * W, Y - a.Yp - a.rho_p * V * V
        return (-b + sqrt(b * b - 4 * rho * c)) / (2 * rho), True, True

    def shear(self, Z: float, h: float) -> float:
        a = self.a
        if self.medium == "fragmented":
            return pi * (a.D0 + (4 * a.Hc0 if a.shear_law == CONOID else 0.0)) * a.tau * a.Hb
        return pi * a.D0 * a.tau * (a.Hb + a.Hc0 + h - Z)

    def drive(self, V: float, W: float) -> float:
        a = self.a
        _, rod, target = self.interface(V, W)
        if self.medium == "plate" and not rod and a.drive_law == INTERFACE:
            return a.Yp * self.A0
        return (self.strength(V, W)[0] if target else a.Yp + a.rho_p * V * (V - W)) * self.A0

    def drives(self, y: np.ndarray) -> bool:
        return self.drive(y[2], 0.0) > self.shear(y[0], y[4])

    def rates(self, _t: float, y: np.ndarray) -> list[float]:
        a = self.a
        Z, L, V, W, h = y
        plate = a.Hb if self.medium != "plate" else a.Hb + a.Hc0 - Z + h - self.h_s
        if self.joined:
            slowing = -self.shear(Z, h) / ((a.rho_p * L + a.rho_B * plate) * self.A0)
            return [V, 0.0, slowing, slowing, W]
        U, rod, _ = self.interface(V, W)
        Y, rho = self.strength(V, W)
        slowing = -(a.Yp if rod else Y + rho * U * (U - W)) / (a.rho_p * L)
        speeding = 0.0
        if self.moving:
            ceramic = a.Hc0 - Z + h if self.medium == "fragmented" else 0.0
            mass = (a.rho_B * plate + a.rho_c * ceramic) * self.A0
            speeding = (self.drive(V, W) - self.shear(Z, h)) / mass
        return [U, -(V - U) if rod else 0.0, slowing, speeding, W]

    def run(self, y: np.ndarray) -> None:
        a, t = self.a, 0.0
        for _ in range(20):
            events = self.events()
            # The slow end in held fragmented ceramic needs no limit.
            longest = np.inf if self.medium == "fragmented" and not self.moving else self.longest * a.D0 / y[2]
            solution: Any = solve_ivp(
                self.rates,
                (t, t + 1.0),
                y,
                self.method,
                events=[event for _, event in events],
                rtol=self.rtol,
                atol=1e-3 * self.rtol,
                max_step=longest,
            )
            assert solution.status == 1, solution.message
            times = [times[0] if len(times) else np.inf for times in solution.t_events]
            which = int(np.argmin(times))
            t, y = float(times[which]), solution.y_events[which][0].copy()
            name = events[which][0]
            if name == "arrest":
                break
            if name == "medium":
                if self.medium == "plate":
                    self.perforated = True
                    break
                if self.medium == "intact":
                    self.medium, self.Vs1 = "fragmented", float(y[2])
                else:
                    self.medium, self.h_s = "plate", float(y[4])
                self.moving = y[3] > 0.0 or self.drives(y)
            elif name == "together":
                self.joined, y[3] = True, y[2]
            elif name == "stops":
                y[3], self.moving = 0.0, False
            elif name == "starts":
                self.moving = True
        else:
            raise AssertionError("no end after 20 events")
        self.V, self.L = float(y[2]), float(y[1])

    def events(self) -> list[tuple[str, Any]]:
        a = self.a
        crack = sqrt(a.Ec / a.rho_c) / 5 if a.Hc0 > 0 else 0.0
        ends = {
            "intact": lambda t, y: a.Hc0 - y[0] - crack * t,
            "fragmented": lambda _t, y: a.Hc0 - y[0],
            "plate": lambda _t, y: a.Hc0 + a.Hb - y[0],
        }
        events: list[tuple[str, Any]] = [("medium", ends[self.medium]), ("arrest", lambda _t, y: y[2] - ARREST)]
        if self.medium != "intact" and not self.joined:
            if self.moving:
                events.append(("stops", lambda _t, y: y[3]))
                if self.medium == "plate":
                    events.append(("together", lambda _t, y: y[2] - y[3]))
            else:
                events.append(("starts", lambda _t, y: self.shear(y[0], y[4]) - self.drive(y[2], y[3])))
        for _, event in events:
            event.terminal = True
            event.direction = -1.0
        return events
