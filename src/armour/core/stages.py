"""Equations that hold in each stage, their rates, and the choice of the stage.

The nine stages of the paper follow from one rule: a side yields where keeping up with the other would take more
pressure than its strength.  A `Stage` records which sides yield; it is constant between two events.
"""

from armour.core import equations as eq
from armour.core.state import Medium, Parameters, Stage, State

# Least plate ahead, as a fraction of Hb: keeps the rates finite in a trial step past the back face.
THINNEST_PLATE = 1e-9


def with_intact_strength(p: Parameters) -> Parameters:
    """Return the parameters with the flow stress that the law of the ceramic gives, and without the law."""
    if p.Hc0 <= 0.0:
        return p
    Yc0 = eq.intact_strength(p.Yc0, p.D0, p.Hc0, p.Hb, p.n_B, p.n_cB, p.a_c, p.a_B)
    # numba lacks `_replace`.
    return Parameters(
        p.L0, p.D0, p.rho_p, p.Yp, p.Hc0, p.rho_c, p.Ec, Yc0, 0.0, 0.0, 0.0, 0.0,
        p.Hb, p.rho_B, p.YB, p.tau, p.shear_law, p.drive_law,
    )  # fmt: skip


def medium_ahead(y: State, s: Stage, p: Parameters) -> tuple[float, float]:
    """Return the strength Y, Pa, and the density rho, kg/m^3, of the medium ahead of the projectile."""
    if s.medium == Medium.PLATE:
        return p.YB, p.rho_B
    if s.medium == Medium.FRAGMENTED:
        return eq.fragmented_strength(p.Yc0, y.V, y.W, s.Vs1), p.rho_c
    return p.Yc0, p.rho_c


def front_velocity(y: State, s: Stage, p: Parameters) -> float:
    """Return the penetration velocity U, m/s."""
    if not s.eroding:
        return y.V
    if not s.penetrated:
        return y.W
    Y, rho = medium_ahead(y, s, p)
    return eq.penetration_velocity(Y, rho, p.Yp, p.rho_p, y.V, y.W)


def shear_force(y: State, s: Stage, p: Parameters) -> float:
    """Return the shear force F of the plate on the material ahead, N (12a), (23a); 0 in intact ceramic."""
    if s.medium == Medium.INTACT:
        return 0.0
    if s.medium == Medium.FRAGMENTED and (s.eroding or s.penetrated):
        D = eq.sheared_diameter(p.shear_law, p.D0, p.Hc0)
        return eq.shear_force_whole_plate(D, p.tau, p.Hb)
    return eq.shear_force_plug(p.D0, p.tau, p.Hb, p.Hc0, y.h, y.Z)


def drive_force(y: State, s: Stage, p: Parameters) -> float:
    """Return the force of the projectile on the material ahead, N (12), (15), (23), (26).

    By `eq.INTERFACE` a rigid projectile drives a plate that it penetrates by the interface force of (28), Yp A0.
    """
    if not s.penetrated:
        pressure = eq.projectile_pressure(p.Yp, p.rho_p, y.V, y.W)
    elif p.drive_law == eq.INTERFACE and s.medium == Medium.PLATE and not s.eroding:
        pressure = p.Yp
    else:
        pressure, _ = medium_ahead(y, s, p)
    return pressure * eq.cross_section(p.D0)


def ceramic_ahead(y: State, s: Stage, p: Parameters) -> float:
    """Return the ceramic ahead of the projectile, m; ceramic left on entering the plate counts as eroded."""
    return 0.0 if s.medium == Medium.PLATE else max(eq.remaining_ceramic(p.Hc0, y.Z, y.h), 0.0)


def plate_ahead(y: State, s: Stage, p: Parameters) -> float:
    """Return the back plate ahead of the projectile, m (22)."""
    if s.medium == Medium.PLATE:
        return max(eq.remaining_plate(p.Hb, p.Hc0, y.Z, y.h, s.h_s), THINNEST_PLATE * p.Hb)
    return p.Hb


def mass_ahead(y: State, s: Stage, p: Parameters) -> float:
    """Return the mass M ahead of the projectile, kg (12b), (23b)."""
    A0 = eq.cross_section(p.D0)
    if s.medium == Medium.PLATE:
        return eq.mass_in_plate(p.rho_B, plate_ahead(y, s, p), A0)
    return eq.mass_behind_ceramic(p.rho_B, p.Hb, p.rho_c, ceramic_ahead(y, s, p), A0)


def joint_deceleration(y: State, s: Stage, p: Parameters) -> float:
    """Return dV/dt of a rigid projectile that carries all material ahead, m/s^2 (31), (33)."""
    F, A0 = shear_force(y, s, p), eq.cross_section(p.D0)
    Hc, Hbc = ceramic_ahead(y, s, p), plate_ahead(y, s, p)
    return eq.carried_deceleration(F, A0, p.rho_p, y.L, p.rho_c, Hc, p.rho_B, Hbc)


def rates(y: State, s: Stage, p: Parameters) -> State:
    """Return the rates of change of the state in a stage, per second (1) to (4), (12) to (33)."""
    U = front_velocity(y, s, p)
    if not (s.eroding or s.penetrated):
        dV = joint_deceleration(y, s, p)
        return State(Z=U, L=0.0, V=dV, W=dV, h=y.W)
    if s.eroding:
        dL = eq.erosion_rate(y.V, U)
        dV = eq.deceleration(p.Yp, p.rho_p, y.L)
    else:
        Y, rho = medium_ahead(y, s, p)
        dL = 0.0
        dV = eq.deceleration(eq.target_pressure(Y, rho, U, y.W), p.rho_p, y.L)
    dW = 0.0
    if s.moving:
        drive, F = drive_force(y, s, p), shear_force(y, s, p)
        dW = eq.target_acceleration(drive, F, mass_ahead(y, s, p))
    return State(Z=U, L=dL, V=dV, W=dW, h=y.W)


def interface_force(y: State, s: Stage, p: Parameters) -> float:
    """Return the force between the projectile and the material ahead, N (5), (8), (20)."""
    A0 = eq.cross_section(p.D0)
    if s.eroding:
        U = front_velocity(y, s, p)
        return eq.projectile_pressure(p.Yp, p.rho_p, y.V, U) * A0
    if s.penetrated:
        Y, rho = medium_ahead(y, s, p)
        return eq.target_pressure(Y, rho, y.V, y.W) * A0
    return -joint_deceleration(y, s, p) * p.rho_p * y.L * A0


def select_stage(medium: int, y: State, p: Parameters, Vs1: float, h_s: float) -> Stage:
    """Return the stage in a medium at a state, by the yielding rule."""
    if medium == Medium.PLATE and y.W >= y.V:
        return Stage(medium, False, False, True, Vs1, h_s)
    s = Stage(medium, True, True, False, Vs1, h_s)
    Y, rho = medium_ahead(y, s, p)
    eroding = eq.projectile_excess(Y, rho, p.Yp, y.V, y.W) > 0.0
    penetrated = eq.target_excess(Y, p.Yp, p.rho_p, y.V, y.W) > 0.0
    s = Stage(medium, eroding, penetrated, False, Vs1, h_s)
    if medium == Medium.INTACT:
        return s
    moving = y.W > 0.0 or drive_force(y, s, p) > shear_force(y, s, p)
    return Stage(medium, eroding, penetrated, moving, Vs1, h_s)


def first_stage(y: State, p: Parameters) -> Stage:
    """Return the stage at impact, in intact ceramic or, without ceramic, in the plate."""
    return select_stage(Medium.INTACT if p.Hc0 > 0.0 else Medium.PLATE, y, p, y.V, 0.0)


def stage_name(s: Stage) -> str:
    """Return the paper's name of a stage.

    The paper lists neither dwell on intact ceramic nor a rigid projectile in it; they have the names of the same
    stages in fragmented ceramic, ii.2 and ii.3.
    """
    if s.medium == Medium.PLATE:
        numbers = ("iii.4", "iii.3", "iii.2", "iii.1")
    elif s.medium == Medium.FRAGMENTED:
        numbers = ("iii.5", "ii.3", "ii.2", "ii.1")
    else:
        numbers = ("iii.5", "ii.3", "ii.2", "i")
    return numbers[2 * s.eroding + s.penetrated]
