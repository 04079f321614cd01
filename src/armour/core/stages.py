"""Which equations hold, their rates, until when they hold, and what follows.

The nine stages of the paper are one rule: a side yields when keeping up with the other would ask more of it than
its strength.  A `Stage` is the answer to that rule between two events; nothing in it changes within a step.
"""

from enum import IntEnum
from math import inf, sqrt

from armour.core import equations as eq
from armour.core.state import Medium, Outcome, Parameters, Stage, State


class Event(IntEnum):
    """Places in what `event_functions` returns."""

    MEDIUM = 0  # the medium ahead ends (7), (13), (19), (32)
    PROJECTILE = 1  # the projectile starts or stops to yield
    TARGET = 2  # the target starts or stops to yield
    MOTION = 3  # the material ahead starts to move or comes to rest
    TOGETHER = 4  # the material ahead has reached the projectile's velocity
    ARREST = 5  # the projectile has stopped
    ERODED = 6  # the projectile is used up


EVENTS = len(Event)

# A projectile this much shorter than at impact counts as eroded away.
ERODED_FRACTION = 1e-3
# Longest step as a fraction of the time in which the motion responds.
LONGEST_RESPONSE = 0.3
# Shortest step as a fraction of the time in which the motion changes by its own size; the error of such is rounding.
SHORTEST_CHANGE = 1e-3
# A trial past the back face leaves no plate; this part of its thickness keeps the rates finite until the step is cut.
THINNEST_PLATE = 1e-9
# Where the deceleration is constant any step is exact; this many of the usual ones are taken at a time.
STEADY_STEPS = 8.0
# Steps in the time in which the motion changes by its own size.
STEPS_PER_CHANGE = 4.0


def medium_ahead(y: State, s: Stage, p: Parameters) -> tuple[float, float]:
    """Strength Y, Pa, and density rho, kg/m^3, of the medium ahead of the projectile."""
    if s.medium == Medium.PLATE:
        return p.YB, p.rho_B
    if s.medium == Medium.FRAGMENTED:
        return eq.fragmented_strength(p.Yc0, y.V, y.W, s.Vs1), p.rho_c
    return p.Yc0, p.rho_c


def front_velocity(y: State, s: Stage, p: Parameters) -> float:
    """Penetration velocity U, m/s."""
    if not s.eroding:
        return y.V
    if not s.penetrated:
        return y.W
    Y, rho = medium_ahead(y, s, p)
    return eq.penetration_velocity(Y, rho, p.Yp, p.rho_p, y.V, y.W)


def shear_force(y: State, s: Stage, p: Parameters) -> float:
    """Shear force F that the plate opposes to the material ahead, N; 0 in intact ceramic."""
    if s.medium == Medium.INTACT:
        return 0.0
    if s.medium == Medium.FRAGMENTED and (s.eroding or s.penetrated):
        D = eq.conoid_diameter(p.D0, p.Hc0) if p.conoid else p.D0
        return eq.shear_force_whole_plate(D, p.tau, p.Hb)
    return eq.shear_force_plug(p.D0, p.tau, p.Hb, p.Hc0, y.h, y.Z)


def drive_force(y: State, s: Stage, p: Parameters) -> float:
    """Force with which the projectile drives the material ahead, N (12), (15), (23), (26)."""
    if s.penetrated:
        pressure, _ = medium_ahead(y, s, p)
    else:
        pressure = eq.projectile_pressure(p.Yp, p.rho_p, y.V, y.W)
    return pressure * eq.cross_section(p.D0)


def ceramic_ahead(y: State, s: Stage, p: Parameters) -> float:
    """Ceramic that remains ahead of the projectile, m; what is left on entering the plate counts as eroded."""
    return 0.0 if s.medium == Medium.PLATE else max(eq.remaining_ceramic(p.Hc0, y.Z, y.h), 0.0)


def plate_ahead(y: State, s: Stage, p: Parameters) -> float:
    """Back plate that remains ahead of the projectile, m."""
    if s.medium == Medium.PLATE:
        return max(eq.remaining_plate(p.Hb, p.Hc0, y.Z, y.h, s.h_s), THINNEST_PLATE * p.Hb)
    return p.Hb


def mass_ahead(y: State, s: Stage, p: Parameters) -> float:
    """Mass M that the projectile drives, kg."""
    A0 = eq.cross_section(p.D0)
    if s.medium == Medium.PLATE:
        return eq.mass_in_plate(p.rho_B, plate_ahead(y, s, p), A0)
    return eq.mass_behind_ceramic(p.rho_B, p.Hb, p.rho_c, ceramic_ahead(y, s, p), A0)


def joint_deceleration(y: State, s: Stage, p: Parameters) -> float:
    """dV/dt of a rigid projectile that carries all ahead of it, m/s^2 (31), (33)."""
    return eq.carried_deceleration(
        shear_force(y, s, p),
        eq.cross_section(p.D0),
        p.rho_p,
        y.L,
        p.rho_c,
        ceramic_ahead(y, s, p),
        p.rho_B,
        plate_ahead(y, s, p),
    )


def rates(y: State, s: Stage, p: Parameters) -> State:
    """Rates of change of the state in the stage, per second (1) to (4), (12) to (33)."""
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
    """Force between the projectile and what is ahead of it, N."""
    A0 = eq.cross_section(p.D0)
    if s.eroding:
        U = front_velocity(y, s, p)
        return eq.projectile_pressure(p.Yp, p.rho_p, y.V, U) * A0
    if s.penetrated:
        Y, rho = medium_ahead(y, s, p)
        return eq.target_pressure(Y, rho, y.V, y.W) * A0
    return -joint_deceleration(y, s, p) * p.rho_p * y.L * A0


def select_stage(medium: int, y: State, p: Parameters, Vs1: float, h_s: float) -> Stage:
    """Stage that holds in the medium at this state, by the rule of yielding."""
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


def stage_name(s: Stage) -> str:
    """The paper's name of a stage.

    The two answers of the rule that the paper does not list in intact ceramic, a projectile that dwells on it and a
    rigid one, go by the names that they have in fragmented ceramic.
    """
    if s.medium == Medium.PLATE:
        numbers = ("iii.4", "iii.3", "iii.2", "iii.1")
    elif s.medium == Medium.FRAGMENTED:
        numbers = ("iii.5", "ii.3", "ii.2", "ii.1")
    else:
        numbers = ("iii.5", "ii.3", "ii.2", "i")
    return numbers[2 * s.eroding + s.penetrated]


def first_stage(y: State, p: Parameters) -> Stage:
    """Stage at impact; a bare plate is struck at once."""
    return select_stage(Medium.INTACT if p.Hc0 > 0.0 else Medium.PLATE, y, p, y.V, 0.0)


def event_functions(
    t: float, y: State, s: Stage, p: Parameters, V_arrest: float
) -> tuple[float, float, float, float, float, float, float]:
    """How far each `Event` is away: positive or 0 while the stage lasts, negative once it has happened."""
    together = projectile = target = motion = inf
    if s.medium == Medium.INTACT:
        medium = p.Hc0 - y.Z - eq.crack_velocity(p.Ec, p.rho_c) * t
    elif s.medium == Medium.FRAGMENTED:
        medium = p.Hc0 - y.Z
    else:
        medium = p.Hc0 + p.Hb - y.Z
    if s.eroding or s.penetrated:
        Y, rho = medium_ahead(y, s, p)
        projectile = eq.projectile_excess(Y, rho, p.Yp, y.V, y.W)
        target = eq.target_excess(Y, p.Yp, p.rho_p, y.V, y.W)
        if not s.eroding:
            projectile = -projectile
        if not s.penetrated:
            target = -target
        if s.moving:
            motion = y.W
            together = y.V - y.W
        elif s.medium != Medium.INTACT:
            motion = shear_force(y, s, p) - drive_force(y, s, p)
    arrest = y.V - V_arrest
    eroded = y.L - ERODED_FRACTION * p.L0
    return medium, projectile, target, motion, together, arrest, eroded


def after_event(event: int, y: State, s: Stage, p: Parameters) -> tuple[State, Stage, Outcome]:
    """State, stage and outcome after an event, from the state that it was landed on."""
    if event == Event.ARREST or event == Event.ERODED:
        return y, s, Outcome.DEFEATED
    if event == Event.MEDIUM:
        if s.medium == Medium.PLATE:
            return y, s, Outcome.PERFORATED
        if s.medium == Medium.INTACT:
            return y, select_stage(Medium.FRAGMENTED, y, p, y.V, s.h_s), Outcome.RUNNING
        return y, select_stage(Medium.PLATE, y, p, s.Vs1, y.h), Outcome.RUNNING
    if event == Event.TOGETHER:
        y = State(y.Z, y.L, y.V, y.V, y.h)
    if event == Event.MOTION and s.moving:
        # Landing on W = 0 is rounding off it, and so is the bulge of a motion that ended as it began.
        y = State(y.Z, y.L, y.V, 0.0, max(y.h, 0.0))
    return y, select_stage(s.medium, y, p, s.Vs1, s.h_s), Outcome.RUNNING


def fastest_rate(y: State, k: State, s: Stage, p: Parameters) -> float:
    """Rate at which the quickest part of the motion responds, 1/s; a step must be short against its inverse."""
    if not (s.eroding or s.penetrated):
        return y.V / y.L
    _, rho = medium_ahead(y, s, p)
    inertia = max(1.0, rho / p.rho_p) * y.V
    # Slope of the rubble's strength (9) over its velocity: a dashpot between projectile and target.
    damping = 0.0
    if s.medium == Medium.FRAGMENTED and s.penetrated:
        damping = 2.0 * p.Yc0 * (y.V - y.W) / (s.Vs1 * s.Vs1)
    projectile = (inertia + sqrt(p.Yp / p.rho_p) + damping / p.rho_p) / y.L
    if not s.moving:
        return projectile
    picking_up = abs(k.W) / y.V
    areal_mass = mass_ahead(y, s, p) / eq.cross_section(p.D0)
    if not s.penetrated:
        return projectile + picking_up + p.rho_p * y.V / areal_mass
    return projectile + picking_up + (rho * (y.V - y.W) + damping) / areal_mass


def step_length(y: State, k: State, s: Stage, p: Parameters, dt: float) -> float:
    """Length of the next step, s: dt, unless the motion has a time scale of its own that has run away from it.

    A rod or a plate that is nearly used up shortens the step.  A motion that has become slow lengthens it: everything
    where dt is no more than rounding to it, and a rigid projectile in held fragmented ceramic, which slows as 1/t, by
    what it has slowed.  So does a rigid projectile that carries everything, whose deceleration is constant.

    Parameters
    ----------
    y, k : State
        The state and its rates.
    """
    if not (s.eroding or s.penetrated):
        dt *= STEADY_STEPS
    if s.medium == Medium.FRAGMENTED and not (s.eroding or s.moving):
        dt *= s.Vs1 / y.V
    change = (abs(k.V) + abs(k.W)) / y.V + k.Z / min(p.D0, p.Hc0 + p.Hb)
    return min(max(dt, SHORTEST_CHANGE / change), LONGEST_RESPONSE / fastest_rate(y, k, s, p))


def default_time_step(p: Parameters, Vi: float) -> float:
    """Time step for an impact at Vi, s: a fixed part of the time in which the motion changes.

    Three rates add up: the front crosses a diameter (or the armour, if thinner), the projectile is slowed, the
    target is picked up.  They scale as 1/size, so that similar cases take the same steps.
    """
    Y = max(p.YB, p.Yc0) if p.Hc0 > 0.0 else p.YB
    crossing = Vi / min(p.D0, p.Hc0 + p.Hb)
    slowing = min(Y, p.Yp) / (p.rho_p * p.L0 * Vi)
    picking_up = min(Y, p.Yp + p.rho_p * Vi * Vi) / ((p.rho_c * p.Hc0 + p.rho_B * p.Hb) * Vi)
    return 1.0 / (STEPS_PER_CHANGE * (crossing + slowing + picking_up))
