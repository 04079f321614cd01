/* One impact and one ballistic limit in C, as a reference for the speed of the compiled engine.

   The equations, steps, events, searches and tolerances are those of src/armour/core, written out by hand; numbers in
   parentheses are equations of the paper. All quantities are in SI units, in the symbols of src/armour/core/state.py.
   Left out are the law of the ceramic's flow stress, time steps given by the user, and records of instants. */

#include <math.h>
#include <stdbool.h>

enum Medium { INTACT, FRAGMENTED, PLATE };
enum Outcome { RUNNING, PERFORATED, STOPPED, UNRESOLVED };
enum Event { MEDIUM, PROJECTILE, TARGET, MOTION, TOGETHER, ARREST, ERODED, EVENTS, NONE = -1 };

/* A row of the engine's table. */
typedef struct {
    double L0, D0, rho_p, Yp;             /* projectile */
    double Hc0, rho_c, Ec, Yc0, law[4];   /* ceramic */
    double Hb, rho_B, YB, tau;            /* back plate */
    double conoid;                        /* shear perimeter of (12a): base of the conoid, or the projectile */
} Parameters;

/* The unknowns, or their rates. */
typedef struct { double Z, L, V, W, h; } State;

typedef struct {
    enum Medium medium;
    bool eroding, penetrated, moving;
    double Vs1, h_s;
} Stage;

/* Result of a run; constant_dV is dV/dt at its end if that is constant up to the end of the armour, else 0. */
typedef struct { enum Outcome outcome; double t; State y; long steps; double constant_dV; } Run;

static const double ERODED_FRACTION = 1e-3, EVENT_TOLERANCE = 1e-11, CUBIC_TOLERANCE = 1e-4, GREATEST_BEND = 0.05;
static const int MAX_TRIALS = 8;

static double least(double a, double b) { return b < a ? b : a; }
static double greatest(double a, double b) { return b > a ? b : a; }

/* Equations in a stage. */

static double cross_section(const Parameters *p) { return M_PI * p->D0 * p->D0 / 4.0; }

/* Strength Y and density rho of the medium ahead (9). */
static double strength(const State *y, const Stage *s, const Parameters *p)
{
    double v = y->V - y->W;
    if (s->medium == PLATE)
        return p->YB;
    return s->medium == INTACT ? p->Yc0 : p->Yc0 / (s->Vs1 * s->Vs1) * (v * v);
}

static double density(const Stage *s, const Parameters *p) { return s->medium == PLATE ? p->rho_B : p->rho_c; }

/* Pressure of the projectile at U = W less the target's strength, which yields where it is positive. */
static double target_excess(double Y, const State *y, const Parameters *p)
{
    return p->Yp + p->rho_p * y->V * (y->V - y->W) - Y;
}

/* Pressure of the target at U = V less the projectile's strength, which yields where it is positive. */
static double projectile_excess(double Y, double rho, const State *y, const Parameters *p)
{
    return Y + rho * y->V * (y->V - y->W) - p->Yp;
}

/* Penetration velocity U (6), (10), (21). */
static double front_velocity(const State *y, const Stage *s, const Parameters *p)
{
    if (!s->eroding)
        return y->V;
    if (!s->penetrated)
        return y->W;
    double mu = density(s, p) / p->rho_p;
    double b = y->V - mu * y->W;
    double c = y->V * y->V - (strength(y, s, p) - p->Yp) * (1.0 / p->rho_p);
    return (sqrt(greatest(b * b + 4.0 * mu * c, 0.0)) - b) * (0.5 / mu);
}

static double sheared_diameter(const Parameters *p) { return p->conoid != 0.0 ? p->D0 + 4.0 * p->Hc0 : p->D0; }

/* Shear force F on the material ahead (12a), (23a). */
static double shear_force(const State *y, const Stage *s, const Parameters *p)
{
    if (s->medium == INTACT)
        return 0.0;
    if (s->medium == FRAGMENTED && (s->eroding || s->penetrated))
        return M_PI * sheared_diameter(p) * p->tau * p->Hb;
    return M_PI * p->D0 * p->tau * (p->Hb + p->Hc0 + y->h - y->Z);
}

/* Force of the projectile on the material ahead (12), (15), (23), (26). */
static double drive_force(const State *y, const Stage *s, const Parameters *p)
{
    double pressure = s->penetrated ? strength(y, s, p) : p->Yp + p->rho_p * y->V * (y->V - y->W);
    return pressure * cross_section(p);
}

static double ceramic_ahead(const State *y, const Stage *s, const Parameters *p)
{
    return s->medium == PLATE ? 0.0 : greatest(p->Hc0 - y->Z + y->h, 0.0);
}

/* Back plate ahead (22). */
static double plate_ahead(const State *y, const Stage *s, const Parameters *p)
{
    if (s->medium != PLATE)
        return p->Hb;
    return greatest(p->Hb + p->Hc0 - y->Z + y->h - s->h_s, 1e-9 * p->Hb);
}

/* Mass M ahead (12b), (23b). */
static double mass_ahead(const State *y, const Stage *s, const Parameters *p)
{
    if (s->medium == PLATE)
        return p->rho_B * cross_section(p) * plate_ahead(y, s, p);
    return (p->rho_B * p->Hb + p->rho_c * ceramic_ahead(y, s, p)) * cross_section(p);
}

/* Rates of the unknowns (1) to (4), (12) to (33). */
static State rates(const State *y, const Stage *s, const Parameters *p)
{
    State k = {.Z = front_velocity(y, s, p), .h = y->W};
    if (!s->eroding && !s->penetrated) { /* (31), (33) */
        double areal = p->rho_p * y->L + p->rho_c * ceramic_ahead(y, s, p) + p->rho_B * plate_ahead(y, s, p);
        k.V = k.W = -shear_force(y, s, p) / (areal * cross_section(p));
        return k;
    }
    if (s->eroding) { /* (2), (3) */
        k.L = -(y->V - k.Z);
        k.V = -p->Yp / (p->rho_p * y->L);
    } else { /* (18), (29) */
        k.V = -(strength(y, s, p) + density(s, p) * k.Z * (k.Z - y->W)) / (p->rho_p * y->L);
    }
    if (s->moving)
        k.W = (drive_force(y, s, p) - shear_force(y, s, p)) / mass_ahead(y, s, p);
    return k;
}

/* Stage in a medium: a side yields where keeping up with the other would take more pressure than its strength. */
static Stage select_stage(enum Medium medium, const State *y, const Parameters *p, double Vs1, double h_s)
{
    Stage s = {medium, true, true, false, Vs1, h_s};
    if (medium == PLATE && y->W >= y->V) {
        s.eroding = s.penetrated = false;
        s.moving = true;
        return s;
    }
    double Y = strength(y, &s, p);
    s.eroding = projectile_excess(Y, density(&s, p), y, p) > 0.0;
    s.penetrated = target_excess(Y, y, p) > 0.0;
    if (medium != INTACT)
        s.moving = y->W > 0.0 || drive_force(y, &s, p) > shear_force(y, &s, p);
    return s;
}

/* The classical Runge-Kutta method of fourth order. */

static State advance(const State *y, const State *k, double dt)
{
    return (State){y->Z + dt * k->Z, y->L + dt * k->L, y->V + dt * k->V, y->W + dt * k->W, y->h + dt * k->h};
}

static State step(const State *y, const State *k1, const Stage *s, const Parameters *p, double dt)
{
    State y2 = advance(y, k1, dt / 2.0), k2 = rates(&y2, s, p);
    State y3 = advance(y, &k2, dt / 2.0), k3 = rates(&y3, s, p);
    State y4 = advance(y, &k3, dt), k4 = rates(&y4, s, p);
    double c = dt / 6.0;
    return (State){
        y->Z + c * (k1->Z + 2.0 * (k2.Z + k3.Z) + k4.Z),
        y->L + c * (k1->L + 2.0 * (k2.L + k3.L) + k4.L),
        y->V + c * (k1->V + 2.0 * (k2.V + k3.V) + k4.V),
        y->W + c * (k1->W + 2.0 * (k2.W + k3.W) + k4.W),
        y->h + c * (k1->h + 2.0 * (k2.h + k3.h) + k4.h),
    };
}

/* Length of a step. */

/* The longest: the characteristic time of the impact. */
static double longest_step(const Parameters *p, double Vi)
{
    double Y = p->Hc0 > 0.0 ? greatest(p->YB, p->Yc0) : p->YB;
    double crossing = Vi / least(p->D0, p->Hc0 + p->Hb);
    double slowing = least(Y, p->Yp) / (p->rho_p * p->L0 * Vi);
    double picking_up = least(Y, p->Yp + p->rho_p * Vi * Vi) / ((p->rho_c * p->Hc0 + p->rho_B * p->Hb) * Vi);
    return 1.0 / (crossing + slowing + picking_up);
}

/* Rate of response of the penetration velocity where both sides yield. */
static double front_rate(const State *y, const State *k, const Stage *s, const Parameters *p, double damping)
{
    double rho = density(s, p);
    double D = p->rho_p * y->V + rho * (2.0 * k->Z - y->W);
    double rising = p->rho_p * (2.0 * y->V - k->Z) * k->V + rho * k->Z * k->W - damping * (k->V - k->W);
    double bend = 2.0 * rho * rising / (D * D);
    return bend > 0.0 ? 1.15 * bend : -3.45 * bend;
}

/* Rate of response of the motion: by inertia, erosion, strength and the shear force. */
static double response_rate(const State *y, const State *k, const Stage *s, const Parameters *p)
{
    double Y = strength(y, s, p), rho = density(s, p), rate;
    double damping = 0.0; /* derivative of the strength of fragments by velocity (9) */
    if (s->medium == FRAGMENTED && s->penetrated)
        damping = 2.0 * p->Yc0 * (y->V - y->W) / (s->Vs1 * s->Vs1);
    double per_mass = s->moving ? cross_section(p) / mass_ahead(y, s, p) : 0.0;
    if (s->eroding) {
        rate = (y->V - 2.0 * k->L + sqrt(p->Yp / p->rho_p) + damping / p->rho_p) / y->L + per_mass * damping;
    } else {
        double settling = damping * (1.0 / (p->rho_p * y->L) + per_mass);
        if (s->moving && s->medium == FRAGMENTED)
            settling = 0.35 * settling + fabs(k->V - k->W) / greatest(y->V - y->W, 0.01 * y->V);
        rate = (2.0 * rho * y->V + 2.5 * sqrt(Y * rho)) / (p->rho_p * y->L) + settling;
    }
    if (s->moving)
        rate += per_mass * (s->penetrated ? rho * (y->V - y->W) : p->rho_p * y->V);
    if (s->moving && s->penetrated && s->medium == PLATE)
        rate += sqrt(per_mass * (4.0 * p->tau / p->D0));
    return s->eroding && s->penetrated ? greatest(rate, front_rate(y, k, s, p, damping)) : rate;
}

/* Time until a projectile at constant deceleration is through the medium or at rest. */
static double time_to_end(const State *y, const State *k, const Stage *s, const Parameters *p)
{
    double end = p->Hc0 + (s->medium == PLATE ? p->Hb : 0.0);
    double left = greatest(end - y->Z, 0.0) + 1e-12 * end;
    double through = 2.0 * left / (y->V + sqrt(greatest(y->V * y->V + 2.0 * k->V * left, 0.0)));
    return least(through, k->V < 0.0 ? y->V / -k->V : INFINITY);
}

static double step_length(const State *y, const State *k, const Stage *s, const Parameters *p, double dt, bool rough)
{
    if (!s->eroding && !s->penetrated)
        return time_to_end(y, k, s, p);
    double response = rough ? 0.6 : 0.23;
    if (s->medium == FRAGMENTED && !s->eroding && !s->moving) {
        dt *= s->Vs1 / y->V;
        response *= rough ? 4.0 : 1.0;
    }
    double size = least(p->D0, p->Hc0 + p->Hb);
    double change = dt * ((fabs(k->V) + fabs(k->W)) * size + k->Z * y->V);
    if (change < 1e-3 * y->V * size)
        dt *= 1e-3 * y->V * size / change;
    double rate = response_rate(y, k, s, p);
    return dt * rate < response ? dt : response / rate;
}

/* Events. */

/* A step in which an event is located: its start and end. */
typedef struct {
    double t, dt;
    State y, k, y_end, k_end;
    Stage s;
    double V_arrest;
} Step;

/* Functions of the events, at least 0 before and negative after each (7), (13), (16), (19), (24), (27), (30), (32). */
static void event_functions(double t, const State *y, const Stage *s, const Parameters *p, double V_arrest, double *g)
{
    g[PROJECTILE] = g[TARGET] = g[MOTION] = g[TOGETHER] = INFINITY;
    g[MEDIUM] = (s->medium == PLATE ? p->Hc0 + p->Hb : p->Hc0) - y->Z;
    if (s->medium == INTACT)
        g[MEDIUM] -= sqrt(p->Ec / p->rho_c) / 5.0 * t;
    if (s->eroding || s->penetrated) {
        double Y = strength(y, s, p);
        g[PROJECTILE] = projectile_excess(Y, density(s, p), y, p);
        g[TARGET] = target_excess(Y, y, p);
        if (!s->eroding)
            g[PROJECTILE] = -g[PROJECTILE];
        if (!s->penetrated)
            g[TARGET] = -g[TARGET];
        if (s->moving) {
            g[MOTION] = y->W;
            g[TOGETHER] = y->V - y->W;
        } else if (s->medium != INTACT) {
            g[MOTION] = shear_force(y, s, p) - drive_force(y, s, p);
        }
    }
    g[ARREST] = y->V - V_arrest;
    g[ERODED] = y->L - ERODED_FRACTION * p->L0;
}

static int first_negative(const double *g, int other_than)
{
    for (int j = 0; j < EVENTS; j++)
        if (j != other_than && !(g[j] >= 0.0))
            return j;
    return NONE;
}

/* State at a fraction x of a step, by the cubic through the states and rates at its ends. */
static State state_within(const Step *w, double x)
{
    double b1 = x * x * (3.0 - 2.0 * x), b0 = 1.0 - b1;
    double c0 = w->dt * x * (1.0 - x) * (1.0 - x), c1 = -w->dt * x * x * (1.0 - x);
    const State *y0 = &w->y, *y1 = &w->y_end, *k0 = &w->k, *k1 = &w->k_end;
    return (State){
        b0 * y0->Z + b1 * y1->Z + c0 * k0->Z + c1 * k1->Z,
        b0 * y0->L + b1 * y1->L + c0 * k0->L + c1 * k1->L,
        b0 * y0->V + b1 * y1->V + c0 * k0->V + c1 * k1->V,
        b0 * y0->W + b1 * y1->W + c0 * k0->W + c1 * k1->W,
        b0 * y0->h + b1 * y1->h + c0 * k0->h + c1 * k1->h,
    };
}

/* Function of event j after a time x dt of a step, in a state. */
static double event_function(int j, const Step *w, double x, const State *y, const Parameters *p)
{
    double g[EVENTS];
    event_functions(w->t + x * w->dt, y, &w->s, p, w->V_arrest, g);
    return g[j];
}

/* Fraction of a step at which event j happens on its cubic, by secants; also a fraction after it, and the slope. */
static double root_on_cubic(int j, const Step *w, const Parameters *p, double g1, double g2, double *high,
                            double *slope)
{
    double low = 0.0, x1 = 0.0, x2 = *high;
    for (int i = 0; i < MAX_TRIALS; i++) {
        *slope = (g2 - g1) / (x2 - x1);
        double x = *slope < 0.0 ? x2 - g2 / *slope : low;
        if (low < x && x < *high && fabs(x - x2) <= CUBIC_TOLERANCE && g2 < 0.0) {
            *high = x2;
            return x;
        }
        x += 0.5 * CUBIC_TOLERANCE;
        if (!(low < x && x < *high))
            x = 0.5 * (low + *high);
        x1 = x2, g1 = g2, x2 = x;
        State y = state_within(w, x);
        g2 = event_function(j, w, x, &y, p);
        *(g2 >= 0.0 ? &low : high) = x;
    }
    return x2;
}

/* Move the fraction `high` of a step, in state y, to just after event j, by steps from its estimate x on. */
static void confirm_event(int j, const Step *w, const Parameters *p, double x, double slope, double *high, State *y)
{
    double low = 0.0, x1 = -1.0, g1 = 0.0;
    for (int trials = 0; *high - low > EVENT_TOLERANCE; trials++) {
        if (trials >= MAX_TRIALS || !(low < x && x < *high))
            x = 0.5 * (low + *high);
        State y_x = step(&w->y, &w->k, &w->s, p, x * w->dt);
        double g = event_function(j, w, x, &y_x, p);
        if (g >= 0.0) {
            low = x;
        } else {
            *high = x, *y = y_x;
            if (g >= slope * EVENT_TOLERANCE)
                return;
        }
        if (trials > 0)
            slope = (g - g1) / (x - x1);
        x1 = x, g1 = g;
        x = slope < 0.0 ? x - g / slope + 0.5 * EVENT_TOLERANCE : low;
    }
}

/* Whether the rates at the ends of a step do not fit the change of the velocities, as far past an event. */
static bool is_bent(const Step *w)
{
    double V = w->y_end.V - w->y.V - 0.5 * w->dt * (w->k.V + w->k_end.V);
    double W = w->y_end.W - w->y.W - 0.5 * w->dt * (w->k.W + w->k_end.W);
    return !(fabs(V) + fabs(W) <= GREATEST_BEND * w->y.V);
}

/* Fraction of a step at which W stops falling or V - W turns; 1 for none. */
static double turning_point(const State *k, const State *k_end)
{
    double turn = 1.0, before = k->V - k->W, after = k_end->V - k_end->W;
    if (k->W < 0.0 && 0.0 < k_end->W)
        turn = k->W / (k->W - k_end->W);
    return before * after < 0.0 ? least(turn, before / (before - after)) : turn;
}

/* Take a step, or the part of it up to its earliest event, which is returned. Set the state at its end, the rates and
   event functions there if no event ended it, and the time taken. */
static int step_to_event(double t, State *y, State *k, double *g, const Stage *s, const Parameters *p, double dt,
                         double V_arrest, bool rough, double *taken)
{
    double fraction = 1.0, g_after[EVENTS];
    Step w = {t, dt, *y, *k, step(y, k, s, p, dt), *k, *s, V_arrest};
    State y_after = w.y_end;
    w.k_end = rates(&w.y_end, s, p);
    event_functions(t + dt, &w.y_end, s, p, V_arrest, g_after);
    int j = first_negative(g_after, NONE);
    if (j == NONE) {
        double turn = s->moving ? turning_point(k, &w.k_end) : 1.0, g_turn[EVENTS];
        if (turn < 1.0) {
            y_after = step(y, k, s, p, turn * dt);
            event_functions(t + turn * dt, &y_after, s, p, V_arrest, g_turn);
            j = first_negative(g_turn, NONE);
        }
        if (j == NONE) {
            *y = w.y_end, *k = w.k_end, *taken = dt;
            for (int i = 0; i < EVENTS; i++)
                g[i] = g_after[i];
            return NONE;
        }
        fraction = turn;
        for (int i = 0; i < EVENTS; i++)
            g_after[i] = g_turn[i];
    }
    int event = j;
    /* An event found shortens the interval, and may reveal another that had come and gone within it. */
    for (int i = 0; i < 2 * EVENTS && j != NONE; i++) {
        event = j;
        if (g[j] < 0.0) {
            fraction = 0.0, y_after = w.y;
        } else if (!(g_after[j] >= EVENT_TOLERANCE * (g_after[j] - g[j]) / fraction)) {
            double after = fraction, slope = 0.0;
            double x = root_on_cubic(j, &w, p, g[j], g_after[j], &after, &slope);
            if (!rough || is_bent(&w))
                confirm_event(j, &w, p, x, slope, &fraction, &y_after);
            else if (after < fraction)
                fraction = after, y_after = state_within(&w, after);
        }
        event_functions(t + fraction * dt, &y_after, s, p, V_arrest, g_after);
        j = first_negative(g_after, event);
    }
    *y = y_after, *taken = fraction * dt;
    return event;
}

/* Change state and stage after an event, and return the outcome. */
static enum Outcome after_event(int event, State *y, Stage *s, const Parameters *p)
{
    if (event == ARREST || event == ERODED)
        return STOPPED;
    if (event == MEDIUM && s->medium == PLATE)
        return PERFORATED;
    if (event == MEDIUM && s->medium == INTACT)
        *s = select_stage(FRAGMENTED, y, p, y->V, s->h_s);
    else if (event == MEDIUM)
        *s = select_stage(PLATE, y, p, s->Vs1, y->h);
    else {
        if (event == TOGETHER)
            y->W = y->V;
        if (event == MOTION && s->moving)
            y->W = 0.0, y->h = greatest(y->h, 0.0);
        *s = select_stage(s->medium, y, p, s->Vs1, s->h_s);
    }
    return RUNNING;
}

/* An impact at Vi, with steps of at most dt. */
static Run run(const Parameters *p, double Vi, double dt, double V_arrest, long max_steps, bool rough)
{
    Run r = {Vi >= V_arrest ? RUNNING : STOPPED, 0.0, {0.0, p->L0, Vi, 0.0, 0.0}, 0, 0.0};
    Stage s = select_stage(p->Hc0 > 0.0 ? INTACT : PLATE, &r.y, p, Vi, 0.0);
    State k = rates(&r.y, &s, p);
    double g[EVENTS], rest = 0.0, taken;
    event_functions(r.t, &r.y, &s, p, V_arrest, g);
    while (r.outcome == RUNNING) {
        if (r.steps == max_steps) {
            r.outcome = UNRESOLVED;
            return r;
        }
        double longest = step_length(&r.y, &k, &s, p, dt, rough);
        double whole = rest > 0.0 ? least(rest, longest) : longest;
        int event = step_to_event(r.t, &r.y, &k, g, &s, p, whole, V_arrest, rough, &taken);
        r.t += taken;
        rest = longest >= dt ? whole - taken : 0.0;
        r.steps++;
        if (event != NONE) {
            r.outcome = after_event(event, &r.y, &s, p);
            k = rates(&r.y, &s, p);
            event_functions(r.t, &r.y, &s, p, V_arrest, g);
        }
    }
    r.constant_dV = s.eroding || s.penetrated ? 0.0 : k.V;
    return r;
}

/* Bound on the energy: docs/design.md. */

/* Least energy per cross-section that perforates the plate. */
static double least_energy_of_plate(const Parameters *p)
{
    double plug = 8.0 * p->tau * p->Hb > p->YB * p->D0 ? p->YB * p->D0 / (8.0 * p->tau) : p->Hb;
    return p->YB * (p->Hb - plug) + 4.0 * p->tau / p->D0 * plug * plug;
}

/* Least energy per cross-section that perforates the armour at an impact velocity V. */
static double least_energy(const Parameters *p, double V)
{
    double plate = least_energy_of_plate(p);
    if (p->Hc0 <= 0.0)
        return plate;
    double rate = 2.0 * p->Yc0 / ((p->rho_p * p->L0 + p->rho_B * p->Hb + p->rho_c * p->Hc0) * V * V);
    double whole = M_PI * sheared_diameter(p) * p->tau * p->Hb, plug = M_PI * p->D0 * p->tau * p->Hb;
    double most = least(whole / 3.0, plug) / cross_section(p), knee = most / rate;
    if (plate >= knee)
        return plate + most * p->Hc0;
    double depth = log(knee / plate) / rate;
    return depth >= p->Hc0 ? plate * exp(rate * p->Hc0) : knee + most * (p->Hc0 - depth);
}

static bool may_perforate(const Parameters *p, double V)
{
    return 2.0 * p->Yp / p->rho_p < V * V || 0.5 * p->rho_p * p->L0 * V * V * 1.01 > least_energy(p, V);
}

/* Search for the ballistic limit. */

typedef struct { double V_arrest; long max_steps; } Solver;

/* An impact, its outcome, how near it is to the other one (the depth, or -f if perforated), and the residual energy f:
   the square of the residual velocity less that of the arrest velocity, continued below the limit, or -inf. */
typedef struct {
    double V;
    bool perforated, eroded, resolved;
    double nearness, f;
} Impact;

/* Two impacts between which the outcome changes; the outcome is the same at both if no change is seen. */
typedef struct { Impact below, above; long runs; } Change;

/* A bracket, and the last points x1, x2 with the residual energies f1, f2; smooth if that is known at its lower end. */
typedef struct {
    double low, high;
    bool smooth;
    int points;
    double x1, f1, x2, f2, estimate, error;
    long runs;
} Bracket;

typedef struct { double low, high; long runs; bool resolved; } Found;

static const double NEAR = 1.05, FAR = 0.6, CLOSE = 0.025, ENERGY_LEFT = 0.65, PARABOLA_ERROR = 0.1, ROUGH_ERROR = 5e-4;
static const double SLOPE_ERROR = 0.02, BEND = 20.0, AGREEMENT = 3e-3, GREATEST_DOUBT = 0.3, ROUNDING = 1e-11;
static const int HIDDEN_RUNS = 10, MAX_INTERPOLATED_RUNS = 30, TRUSTED_RUNS = 4;

static Impact impact(const Parameters *p, double V, const Solver *solver, bool rough)
{
    Run end = run(p, V, longest_step(p, V), solver->V_arrest, solver->max_steps, rough);
    bool resolved = end.outcome != UNRESOLVED;
    double f = end.y.V * end.y.V - solver->V_arrest * solver->V_arrest;
    if (end.outcome == PERFORATED)
        return (Impact){V, true, false, resolved, -f, f};
    /* A projectile that stops at a constant deceleration (33) lacks energy in proportion to the armour that is left. */
    f = end.constant_dV < 0.0 ? f + 2.0 * end.constant_dV * (p->Hc0 + p->Hb - end.y.Z) : -INFINITY;
    return (Impact){V, false, end.y.L < ERODED_FRACTION * p->L0, resolved, end.y.Z, f};
}

/* An impact by a rough run or, where it is close to the other outcome, by a usual one. */
static Impact scanned_impact(const Parameters *p, double V, const Solver *solver)
{
    Impact tried = impact(p, V, solver, true);
    double close = tried.perforated ? -CLOSE * V * V : (1.0 - CLOSE) * (p->Hc0 + p->Hb);
    return tried.nearness > close || !tried.resolved ? impact(p, V, solver, false) : tried;
}

/* A change between near velocities, both ends by usual runs; the lower is moved down to one that stands. */
static Change confirmed(const Parameters *p, const Impact *start, Change c, const Solver *solver)
{
    double V = c.below.V;
    c.above = impact(p, c.above.V, solver, false), c.runs = 1;
    if (!c.above.resolved || c.above.perforated == c.below.perforated)
        return c;
    double ratio = c.above.V / V;
    for (;;) {
        c.below = impact(p, V, solver, false), c.runs++;
        if (!c.below.resolved)
            return (Change){c.below, c.below, c.runs};
        if (c.below.perforated != c.above.perforated)
            return c;
        c.above = c.below;
        V = V / ratio < start->V && start->V < V ? start->V : V / ratio;
    }
}

/* Search around the nearest of three impacts to the other outcome, by golden section. */
static Change change_at_peak(const Parameters *p, Impact below, Impact peak, Impact above, const Solver *solver)
{
    const double GOLDEN = (3.0 - sqrt(5.0)) / 2.0;
    for (int i = 0; i < HIDDEN_RUNS; i++) {
        bool upper = above.V - peak.V > peak.V - below.V;
        Impact tried = scanned_impact(p, peak.V + GOLDEN * ((upper ? above.V : below.V) - peak.V), solver);
        if (!tried.resolved || tried.perforated != peak.perforated)
            return (Change){upper ? peak : below, tried, i + 1};
        if (tried.nearness > peak.nearness) {
            *(upper ? &below : &above) = peak;
            peak = tried;
        } else
            *(upper ? &above : &below) = tried;
    }
    return (Change){peak, peak, HIDDEN_RUNS};
}

/* Search between a projectile that stops and one that is used up for one that perforates. */
static Change change_between_causes(const Parameters *p, Impact below, Impact above, const Solver *solver)
{
    for (int i = 0; i < HIDDEN_RUNS; i++) {
        Impact tried = scanned_impact(p, 0.5 * (below.V + above.V), solver);
        if (!tried.resolved || tried.perforated)
            return (Change){below, tried, i + 1};
        *(tried.eroded == below.eroded ? &below : &above) = tried;
    }
    return (Change){below, below, HIDDEN_RUNS};
}

static bool differs(const Impact *impact, const Impact *other)
{
    return !impact->resolved || impact->perforated != other->perforated;
}

/* Whether a scan may pass over a velocity: the last impact has stopped far from the back face. */
static bool is_far(const Parameters *p, const Impact *last, double V)
{
    return !last->perforated && NEAR * last->V < V && last->nearness < FAR * (p->Hc0 + p->Hb);
}

/* Whether a faster projectile stops as the last one did, and deeper: between them none perforates. */
static bool rises(const Impact *last, const Impact *ahead)
{
    return ahead->resolved && !ahead->perforated && ahead->eroded == last->eroded && ahead->nearness > last->nearness;
}

/* The lowest change of the outcome above an impact that a scan sees. */
static Change next_change(const Parameters *p, Impact before, Impact start, const double *velocities, long n,
                          const Solver *solver)
{
    Impact last = start, ahead = start;
    long i = 0, runs = 0;
    while (i < n && velocities[i] <= start.V)
        i++;
    for (; i < n; i++) {
        double V = velocities[i];
        if (V > ahead.V && i + 1 < n && is_far(p, &last, V)) {
            ahead = scanned_impact(p, velocities[i + 1], solver);
            runs++;
            if (rises(&last, &ahead))
                V = ahead.V, i++;
        }
        Impact end = ahead;
        if (V != ahead.V)
            end = scanned_impact(p, V, solver), runs++;
        if (end.resolved && end.perforated != last.perforated && V < NEAR * last.V) {
            Change sure = confirmed(p, &start, (Change){last, end, 0}, solver);
            runs += sure.runs, last = sure.below, end = sure.above;
        }
        if (differs(&end, &last))
            return (Change){last, end, runs};
        Change hidden = {last, last, 0};
        if (end.eroded != last.eroded)
            hidden = change_between_causes(p, last, end, solver);
        else if (before.eroded == last.eroded && before.nearness < last.nearness && last.nearness > end.nearness)
            hidden = change_at_peak(p, before, last, end, solver);
        runs += hidden.runs;
        if (hidden.above.resolved && hidden.above.perforated != last.perforated) {
            hidden = confirmed(p, &start, hidden, solver);
            runs += hidden.runs;
        }
        if (differs(&hidden.above, &hidden.below))
            return (Change){hidden.below, hidden.above, runs};
        before = last, last = end;
    }
    return (Change){last, last, runs};
}

/* Root of x as a polynomial of f through a point and one or two earlier ones. */
static double extrapolated_root(const Bracket *b, double x, double f)
{
    if (f == b->f1)
        return x;
    double line = x - f * (b->x1 - x) / (b->f1 - f);
    if (b->points == 1 || b->f1 == b->f2 || f == b->f2)
        return line;
    double other = b->x1 - b->f1 * (b->x2 - b->x1) / (b->f2 - b->f1);
    return line - f * (other - line) / (b->f2 - f);
}

/* Add a point to a bracket, except the first, of which the estimate and its error are given. */
static void add_point(Bracket *b, double x, double f)
{
    double estimate = extrapolated_root(b, x, f);
    b->error = fabs(estimate - b->estimate), b->estimate = estimate;
    b->points = b->points < 3 ? b->points + 1 : 3;
    b->x2 = b->x1, b->f2 = b->f1, b->x1 = x, b->f1 = f;
}

/* Narrow a bracket by an impact at x. */
static void after(Bracket *b, double x, const Impact *tried)
{
    if (!tried->perforated)
        b->smooth = tried->f > -INFINITY;
    if (tried->f > -INFINITY)
        add_point(b, x, tried->f);
    *(tried->perforated ? &b->high : &b->low) = x;
    b->runs++;
}

static bool is_converged(const Bracket *b, double tolerance)
{
    double middle = 0.5 * (b->low + b->high);
    return b->high - b->low <= tolerance || !(b->low < middle && middle < b->high);
}

static double next_point(const Bracket *b, double tolerance)
{
    double middle = 0.5 * (b->low + b->high), away = b->high - b->estimate, x;
    if (b->runs > MAX_INTERPOLATED_RUNS)
        return middle;
    if (away <= 0.7 * tolerance) {
        x = b->high - 0.9 * tolerance;
    } else {
        const double margins[] = {0.0, b->error, 0.03 * away, PARABOLA_ERROR * b->error};
        double margin = b->smooth ? 0.0 : margins[b->points];
        x = b->estimate + greatest(margin, tolerance / 3.0);
        if (x <= b->low)
            x = b->low + 4.0 * greatest(margin, b->low - b->estimate);
    }
    return b->low < x && x < b->high ? x : middle;
}

/* The interval that contains x of those into which bisection divides an interval. */
static void bisected(double x, double *low, double *high, double tolerance)
{
    while (*high - *low > tolerance) {
        double middle = 0.5 * (*low + *high);
        if (!(*low < middle && middle < *high))
            break;
        *(x < middle ? high : low) = middle;
    }
}

/* Where the outcome changes by rough runs, the derivative of the velocity by the residual energy, and its error. */
typedef struct {
    double x, slope, doubt;
    long runs;
    bool resolved;
} Root;

/* Search between two signed velocities, by rough runs, for the signed square of the velocity. */
static Root rough_root(const Parameters *p, double low, double high, const Impact *first, const Impact *other,
                       double sign, const Solver *solver)
{
    double guess = sign * high * high - first->f / ENERGY_LEFT;
    double slope = 1.0 / ENERGY_LEFT, doubt = 1.0, tolerance = 2.0 * ROUGH_ERROR * high * high;
    Bracket b = {.low = sign * low * low, .high = sign * high * high, .points = 1, .estimate = guess, .runs = 1};
    b.x1 = b.high, b.f1 = first->f, b.error = 0.2 * fabs(b.high - guess);
    after(&b, b.low, other);
    while ((b.points < 3 ? b.error : PARABOLA_ERROR * b.error) > tolerance && !is_converged(&b, tolerance)) {
        double x = next_point(&b, tolerance);
        Impact tried = impact(p, sqrt(fabs(x)), solver, true);
        if (!tried.resolved)
            return (Root){tried.V, slope, doubt, b.runs - 1, false};
        after(&b, x, &tried);
    }
    if (b.points > 2 && b.x1 != b.estimate && b.f1 != b.f2) {
        double s1 = (b.x1 - b.estimate) / b.f1, s2 = (b.x2 - b.estimate) / b.f2;
        slope = (s1 * b.f2 - s2 * b.f1) / (b.f2 - b.f1);
        doubt = SLOPE_ERROR + fabs((b.x1 - b.estimate) / (b.f1 * slope) - 1.0);
    }
    double V = sqrt(fabs(least(greatest(b.estimate, b.low), b.high)));
    return (Root){sign * V, 0.5 * slope / V, doubt, b.runs - 2, true};
}

/* An estimate of where the residual energy is zero, its error, and the last usual run with a known f. */
typedef struct { double x, error, slope, x1, f1; } Zero;

/* Move the estimate after a usual run at x; it is trusted if it agrees with the one before it. */
static void after_usual(Zero *zero, const Root *rough, double x, double f, bool trusted)
{
    double doubt = 1.0 + rough->doubt;
    if (zero->f1 == -INFINITY || zero->f1 == f) {
        trusted = trusted && rough->doubt <= GREATEST_DOUBT;
    } else {
        double slope = (x - zero->x1) / (f - zero->f1);
        doubt = rough->doubt + fabs(slope / zero->slope - 1.0) + BEND * fabs((x - zero->x1) / x);
        zero->slope = slope;
    }
    double root = x - zero->slope * f;
    trusted = trusted && fabs(root - zero->x) <= AGREEMENT * fabs(x);
    double error = greatest(doubt * fabs(x - root), ROUNDING * fabs(x));
    *zero = (Zero){root, trusted ? error : INFINITY, zero->slope, x, f};
}

/* Narrow a change of the outcome to the bracket that bisection finds. Usual runs at ends of its intervals estimate
   where the residual energy is zero; an end further away than the error is known without a run, unless the change is
   between near velocities. Velocities are negative where the outcome above the change is stop. */
static Found narrowed(const Parameters *p, const Change *change, double tolerance, const Solver *solver)
{
    double sign = change->above.perforated ? 1.0 : -1.0;
    const Impact *first = change->above.perforated ? &change->above : &change->below;
    const Impact *other = change->above.perforated ? &change->below : &change->above;
    double low = sign * other->V, high = sign * first->V, stopped = low, perforated = high, beyond = 0.0;
    Root rough = rough_root(p, low, high, first, other, sign, solver);
    if (!rough.resolved)
        return (Found){rough.x, rough.x, rough.runs, false};
    int trusted = change->above.V > NEAR * change->below.V ? TRUSTED_RUNS : 0;
    Zero zero = {rough.x, INFINITY, rough.slope, 0.0, -INFINITY};
    for (long runs = 0;;) {
        if (runs > MAX_INTERPOLATED_RUNS || !(stopped <= zero.x && zero.x < perforated))
            zero.x = 0.5 * (stopped + perforated), zero.error = INFINITY;
        double start = low, end = high;
        bisected(zero.x, &start, &end, tolerance);
        bool start_known = stopped >= start || zero.x - start > zero.error;
        bool end_known = perforated <= end || end - zero.x > zero.error;
        if (start_known && end_known) {
            runs += rough.runs;
            return sign < 0.0 ? (Found){-end, -start, runs, true} : (Found){start, end, runs, true};
        }
        double x = end_known || (!start_known && zero.x - start < end - zero.x) ? start : end;
        Impact tried = impact(p, sign * x, solver, false);
        runs++;
        if (!tried.resolved)
            return (Found){tried.V, tried.V, rough.runs + runs, false};
        *(tried.perforated ? &perforated : &stopped) = x;
        if (tried.f > -INFINITY) {
            after_usual(&zero, &rough, x, tried.f, runs <= trusted);
        } else {
            beyond = 4.0 * beyond + ROUGH_ERROR * fabs(x);
            zero.x = x + beyond, zero.error = INFINITY;
        }
    }
}

/* The ballistic limit: the lowest change of the outcome that a scan of n velocities sees. */
static Found ballistic_limit(const Parameters *p, const double *velocities, long n, double tolerance,
                             const Solver *solver)
{
    long i = 0;
    while (i + 1 < n && !may_perforate(p, velocities[i + 1]))
        i++;
    Impact start = scanned_impact(p, velocities[i], solver), before = start;
    if (i > 0)
        before = (Impact){velocities[i - 1], false, start.eroded, true, -INFINITY, -INFINITY};
    if (!start.resolved)
        return (Found){start.V, start.V, 1, false};
    if (start.perforated)
        return (Found){-INFINITY, start.V, 1, true};
    Change change = next_change(p, before, start, velocities, n, solver);
    if (!change.above.resolved)
        return (Found){change.above.V, change.above.V, change.runs + 1, false};
    if (!change.above.perforated)
        return (Found){change.above.V, INFINITY, change.runs + 1, true};
    Found found = narrowed(p, &change, tolerance, solver);
    found.runs += change.runs + 1;
    return found;
}

/* Called by the benchmark, for n rows. */

/* Write the outcome and steps, and the duration and final state, of each impact. */
void impacts(const Parameters *rows, const double *velocities, long n, double V_arrest, long max_steps,
             long (*counts)[2], double (*ends)[6])
{
    for (long i = 0; i < n; i++) {
        Run r = run(&rows[i], velocities[i], longest_step(&rows[i], velocities[i]), V_arrest, max_steps, false);
        counts[i][0] = r.outcome, counts[i][1] = r.steps;
        ends[i][0] = r.t;
        *(State *)(ends[i] + 1) = r.y;
    }
}

/* Write the runs of each search and whether it is resolved, and its bracket. */
void ballistic_limits(const Parameters *rows, long n, const double *velocities, long points, double tolerance,
                      double V_arrest, long max_steps, long (*counts)[2], double (*ends)[2])
{
    const Solver solver = {V_arrest, max_steps};
    for (long i = 0; i < n; i++) {
        Found found = ballistic_limit(&rows[i], velocities, points, tolerance, &solver);
        counts[i][0] = found.runs, counts[i][1] = found.resolved;
        ends[i][0] = found.low, ends[i][1] = found.high;
    }
}
