/* The core, src/armour/core, written out in C for the benchmark; docstrings and comments are there. */

#include <math.h>
#include <stdbool.h>

static double least(double a, double b) { return b < a ? b : a; }
static double greatest(double a, double b) { return b > a ? b : a; }

/* state.py */
enum { INTACT, FRAGMENTED, PLATE };
enum { RUNNING, PERFORATED, STOPPED, UNRESOLVED };

typedef struct {
    double L0, D0, rho_p, Yp, Hc0, rho_c, Ec, Yc0, n_B, n_cB, a_c, a_B, Hb, rho_B, YB, tau, shear_law, drive_law;
} Parameters;

typedef struct { double Z, L, V, W, h; } State;
typedef struct { int medium; bool eroding, penetrated, moving; double Vs1, h_s; } Stage;

/* equations.py */
static const double CONOID = 1.0, INTERFACE = 1.0, MIN_FACTOR = 0.05, MAX_FACTOR = 20.0, THINNEST_CERAMIC = 1e-15;

static double cross_section(double D0) { return M_PI * D0 * D0 / 4.0; }
static double crack_velocity(double Ec, double rho_c) { return sqrt(Ec / rho_c) / 5.0; }
static double intact_strength(double Yc0, double D0, double Hc0, double Hb, double n_B, double n_cB, double a_c,
                              double a_B) {
    double c = greatest(Hc0 / D0, THINNEST_CERAMIC), b = Hb / D0;
    double factor = pow(b, n_B) * pow(c * b, n_cB) * (1.0 + a_c * (c - 1.0) + a_B * (b - 1.0));
    return Yc0 * least(greatest(factor, MIN_FACTOR), MAX_FACTOR);
}
static double fragmented_strength(double Yc0, double V, double W, double Vs1) {
    double v = V - W;
    return Yc0 / (Vs1 * Vs1) * (v * v);
}
static double projectile_pressure(double Yp, double rho_p, double V, double U) { return Yp + rho_p * V * (V - U); }
static double target_pressure(double Y, double rho, double U, double W) { return Y + rho * U * (U - W); }
static double penetration_velocity(double Y, double rho, double Yp, double rho_p, double V, double W) {
    double mu = rho / rho_p, b = V - mu * W, c = V * V - (Y - Yp) * (1.0 / rho_p);
    return (sqrt(greatest(b * b + 4.0 * mu * c, 0.0)) - b) * (0.5 / mu);
}
static double target_excess(double Y, double Yp, double rho_p, double V, double W) {
    return Yp + rho_p * V * (V - W) - Y;
}
static double projectile_excess(double Y, double rho, double Yp, double V, double W) {
    return Y + rho * V * (V - W) - Yp;
}
static double erosion_rate(double V, double U) { return -(V - U); }
static double deceleration(double pressure, double rho_p, double L) { return -pressure / (rho_p * L); }
static double carried_deceleration(double F, double A0, double rho_p, double L, double rho_c, double Hc, double rho_B,
                                   double Hbc) {
    return -F / ((rho_p * L + rho_c * Hc + rho_B * Hbc) * A0);
}
static double target_acceleration(double drive, double F, double M) { return (drive - F) / M; }
static double mass_behind_ceramic(double rho_B, double Hb, double rho_c, double Hc, double A0) {
    return (rho_B * Hb + rho_c * Hc) * A0;
}
static double mass_in_plate(double rho_B, double Hbc, double A0) { return rho_B * A0 * Hbc; }
static double sheared_diameter(double law, double D0, double Hc0) { return law == CONOID ? D0 + 4.0 * Hc0 : D0; }
static double shear_force_whole_plate(double D, double tau, double Hb) { return M_PI * D * tau * Hb; }
static double shear_force_plug(double D0, double tau, double Hb, double Hc0, double h, double Z) {
    return M_PI * D0 * tau * (Hb + Hc0 + h - Z);
}
static double remaining_ceramic(double Hc0, double Z, double h) { return Hc0 - Z + h; }
static double remaining_plate(double Hb, double Hc0, double Z, double h, double h_s) { return Hb + Hc0 - Z + h - h_s; }

/* stages.py */
static const double THINNEST_PLATE = 1e-9;

static Parameters with_intact_strength(Parameters p) {
    if (p.Hc0 <= 0.0 || (p.n_B == 0.0 && p.n_cB == 0.0 && p.a_c == 0.0 && p.a_B == 0.0)) return p;
    p.Yc0 = intact_strength(p.Yc0, p.D0, p.Hc0, p.Hb, p.n_B, p.n_cB, p.a_c, p.a_B);
    p.n_B = p.n_cB = p.a_c = p.a_B = 0.0;
    return p;
}

static double medium_ahead(State y, Stage s, Parameters p, double *rho) {
    *rho = s.medium == PLATE ? p.rho_B : p.rho_c;
    if (s.medium == PLATE) return p.YB;
    return s.medium == FRAGMENTED ? fragmented_strength(p.Yc0, y.V, y.W, s.Vs1) : p.Yc0;
}

static double front_velocity(State y, Stage s, Parameters p) {
    if (!s.eroding) return y.V;
    if (!s.penetrated) return y.W;
    double rho, Y = medium_ahead(y, s, p, &rho);
    return penetration_velocity(Y, rho, p.Yp, p.rho_p, y.V, y.W);
}

static double shear_force(State y, Stage s, Parameters p) {
    if (s.medium == INTACT) return 0.0;
    if (s.medium == FRAGMENTED && (s.eroding || s.penetrated))
        return shear_force_whole_plate(sheared_diameter(p.shear_law, p.D0, p.Hc0), p.tau, p.Hb);
    return shear_force_plug(p.D0, p.tau, p.Hb, p.Hc0, y.h, y.Z);
}

static double drive_force(State y, Stage s, Parameters p) {
    double rho, A0 = cross_section(p.D0);
    if (!s.penetrated) return projectile_pressure(p.Yp, p.rho_p, y.V, y.W) * A0;
    if (p.drive_law == INTERFACE && s.medium == PLATE && !s.eroding) return p.Yp * A0;
    return medium_ahead(y, s, p, &rho) * A0;
}

static double ceramic_ahead(State y, Stage s, Parameters p) {
    return s.medium == PLATE ? 0.0 : greatest(remaining_ceramic(p.Hc0, y.Z, y.h), 0.0);
}

static double plate_ahead(State y, Stage s, Parameters p) {
    if (s.medium != PLATE) return p.Hb;
    return greatest(remaining_plate(p.Hb, p.Hc0, y.Z, y.h, s.h_s), THINNEST_PLATE * p.Hb);
}

static double mass_ahead(State y, Stage s, Parameters p) {
    double A0 = cross_section(p.D0);
    if (s.medium == PLATE) return mass_in_plate(p.rho_B, plate_ahead(y, s, p), A0);
    return mass_behind_ceramic(p.rho_B, p.Hb, p.rho_c, ceramic_ahead(y, s, p), A0);
}

static double joint_deceleration(State y, Stage s, Parameters p) {
    return carried_deceleration(shear_force(y, s, p), cross_section(p.D0), p.rho_p, y.L, p.rho_c,
                                ceramic_ahead(y, s, p), p.rho_B, plate_ahead(y, s, p));
}

static State rates(State y, Stage s, Parameters p) {
    double U = front_velocity(y, s, p), dL = 0.0, dV, dW = 0.0;
    if (!(s.eroding || s.penetrated)) {
        dV = joint_deceleration(y, s, p);
        return (State){U, 0.0, dV, dV, y.W};
    }
    double rho, Y = medium_ahead(y, s, p, &rho);
    if (s.eroding) dL = erosion_rate(y.V, U), dV = deceleration(p.Yp, p.rho_p, y.L);
    else dV = deceleration(target_pressure(Y, rho, U, y.W), p.rho_p, y.L);
    if (s.moving) dW = target_acceleration(drive_force(y, s, p), shear_force(y, s, p), mass_ahead(y, s, p));
    return (State){U, dL, dV, dW, y.W};
}

static Stage select_stage(int medium, State y, Parameters p, double Vs1, double h_s) {
    if (medium == PLATE && y.W >= y.V) return (Stage){medium, false, false, true, Vs1, h_s};
    Stage s = {medium, true, true, false, Vs1, h_s};
    double rho, Y = medium_ahead(y, s, p, &rho);
    s.eroding = projectile_excess(Y, rho, p.Yp, y.V, y.W) > 0.0;
    s.penetrated = target_excess(Y, p.Yp, p.rho_p, y.V, y.W) > 0.0;
    s.moving = medium != INTACT && (y.W > 0.0 || drive_force(y, s, p) > shear_force(y, s, p));
    return s;
}

static Stage first_stage(State y, Parameters p) { return select_stage(p.Hc0 > 0.0 ? INTACT : PLATE, y, p, y.V, 0.0); }

/* rk4.py */
typedef struct { double t, dt; State y, k, y_end, k_end, error; } Step;

static State moved(State y, State k, double dt) {
    return (State){y.Z + dt * k.Z, y.L + dt * k.L, y.V + dt * k.V, y.W + dt * k.W, y.h + dt * k.h};
}

static State mean(State k1, State k2, State k3, State k4) {
    return (State){
        (k1.Z + 2.0 * (k2.Z + k3.Z) + k4.Z) / 6.0, (k1.L + 2.0 * (k2.L + k3.L) + k4.L) / 6.0,
        (k1.V + 2.0 * (k2.V + k3.V) + k4.V) / 6.0, (k1.W + 2.0 * (k2.W + k3.W) + k4.W) / 6.0,
        (k1.h + 2.0 * (k2.h + k3.h) + k4.h) / 6.0,
    };
}

static Step step(double t, State y, State k, Stage s, Parameters p, double dt) {
    State k2 = rates(moved(y, k, 0.5 * dt), s, p);
    State k3 = rates(moved(y, k2, 0.5 * dt), s, p);
    State k4 = rates(moved(y, k3, dt), s, p);
    State y_end = moved(y, mean(k, k2, k3, k4), dt);
    State e = rates(y_end, s, p);
    double c = dt / 6.0;
    State error = {c * (e.Z - k4.Z), c * (e.L - k4.L), c * (e.V - k4.V), c * (e.W - k4.W), c * (e.h - k4.h)};
    return (Step){t, dt, y, k, y_end, e, error};
}

static State state_within(State y0, State k0, State y1, State k1, double dt, double x) {
    double b1 = x * x * (3.0 - 2.0 * x);
    double c0 = dt * x * (1.0 - x) * (1.0 - x), c1 = -dt * x * x * (1.0 - x);
    return (State){
        y0.Z + b1 * (y1.Z - y0.Z) + c0 * k0.Z + c1 * k1.Z, y0.L + b1 * (y1.L - y0.L) + c0 * k0.L + c1 * k1.L,
        y0.V + b1 * (y1.V - y0.V) + c0 * k0.V + c1 * k1.V, y0.W + b1 * (y1.W - y0.W) + c0 * k0.W + c1 * k1.W,
        y0.h + b1 * (y1.h - y0.h) + c0 * k0.h + c1 * k1.h,
    };
}

/* roots.py */
static const int MOST_TRIALS = 100;
typedef struct { double x1, f1, x2, f2, x3, f3; } Bracket;

static Bracket bracket(double x1, double f1, double x2, double f2) { return (Bracket){x1, f1, x2, f2, x2, f2}; }

static double next_point(Bracket b, double tolerance) {
    double width = b.x2 - b.x1, part;
    if (b.x3 == b.x2) part = b.f1 / (b.f1 - b.f2);
    else {
        double xi = width / (b.x2 - b.x3), phi = (b.f1 - b.f2) / (b.f3 - b.f2);
        part = 0.5;
        if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
            part = b.f1 / (b.f2 - b.f1) * b.f3 / (b.f2 - b.f3);
            part += (b.x3 - b.x1) / width * b.f1 / (b.f3 - b.f1) * b.f2 / (b.f3 - b.f2);
        }
    }
    double inside = least(tolerance / fabs(width), 0.5);
    return b.x1 + least(greatest(part, inside), 1.0 - inside) * width;
}

static Bracket narrowed(Bracket b, double x, double f) {
    if ((f < 0.0) == (b.f1 < 0.0)) return (Bracket){x, f, b.x2, b.f2, b.x1, b.f1};
    return (Bracket){x, f, b.x1, b.f1, b.x2, b.f2};
}

/* events.py */
enum { MEDIUM, PROJECTILE, TARGET, MOTION, TOGETHER, ARREST, ERODED, EVENTS };
static const double ERODED_FRACTION = 1e-3, EVENT_WIDTH = 1e-12;
typedef struct { double of[EVENTS]; } Margins;

static Margins event_functions(double t, State y, Stage s, Parameters p, double V_arrest) {
    double medium, projectile = INFINITY, target = INFINITY, motion = INFINITY, together = INFINITY;
    if (s.medium == INTACT) medium = p.Hc0 - y.Z - crack_velocity(p.Ec, p.rho_c) * t;
    else if (s.medium == FRAGMENTED) medium = p.Hc0 - y.Z;
    else medium = p.Hc0 + p.Hb - y.Z;
    if (s.eroding || s.penetrated) {
        double rho, Y = medium_ahead(y, s, p, &rho);
        projectile = projectile_excess(Y, rho, p.Yp, y.V, y.W);
        target = target_excess(Y, p.Yp, p.rho_p, y.V, y.W);
        if (!s.eroding) projectile = -projectile;
        if (!s.penetrated) target = -target;
        if (s.moving) motion = y.W, together = y.V - y.W;
        else if (s.medium != INTACT) motion = shear_force(y, s, p) - drive_force(y, s, p);
    }
    return (Margins){{medium, projectile, target, motion, together, y.V - V_arrest, y.L - ERODED_FRACTION * p.L0}};
}

static Margins functions_within(Step w, double x, Stage s, Parameters p, double V_arrest) {
    State y = state_within(w.y, w.k, w.y_end, w.k_end, w.dt, x);
    return event_functions(w.t + x * w.dt, y, s, p, V_arrest);
}

static int negative(Margins g, int other_than) {
    for (int j = 0; j < EVENTS; j++)
        if (j != other_than && !(g.of[j] >= 0.0)) return j;
    return -1;
}

static int first_event(Step whole, Margins g, Margins g_end, Stage s, Parameters p, double V_arrest, double *x) {
    int event = -1;
    Margins g_x = g_end;
    *x = 1.0;
    for (int i = 0; i < EVENTS; i++) {
        int j = negative(g_x, event);
        if (j < 0) break;
        event = j;
        if (g.of[j] < 0.0) return *x = 0.0, j;
        Bracket b = bracket(*x, g_x.of[j], 0.0, g.of[j]);
        for (int trial = 0; trial < MOST_TRIALS && !(fabs(b.x2 - b.x1) <= EVENT_WIDTH); trial++) {
            *x = next_point(b, 0.95 * EVENT_WIDTH);
            b = narrowed(b, *x, functions_within(whole, *x, s, p, V_arrest).of[j]);
        }
        *x = greatest(b.x1, b.x2);
        g_x = functions_within(whole, *x, s, p, V_arrest);
    }
    return event;
}

static int after_event(int event, State *y, Stage *s, Parameters p) {
    y->W = greatest(y->W, 0.0), y->h = greatest(y->h, 0.0);
    if (event == ARREST || event == ERODED) return STOPPED;
    if (event == MEDIUM && s->medium == PLATE) return PERFORATED;
    if (event == TOGETHER) y->W = y->V;
    if (event == MOTION && s->moving) y->W = 0.0;
    if (event != MEDIUM) *s = select_stage(s->medium, *y, p, s->Vs1, s->h_s);
    else if (s->medium == INTACT) *s = select_stage(FRAGMENTED, *y, p, y->V, s->h_s);
    else *s = select_stage(PLATE, *y, p, s->Vs1, y->h);
    return RUNNING;
}

/* run.py */
static const double TOLERANCE = 4e-7, SAFETY = 0.9, LEAST_CHANGE = 0.2, GREATEST_CHANGE = 5.0, FIRST_STEP = 0.1;
typedef struct { int outcome; double t; State y; long steps; double constant_dV; } Run;

static double allowed_change(State error, Parameters p, double Vi, double tolerance) {
    double worst = fabs(error.Z) / (p.Hc0 + p.Hb) + fabs(error.L) / p.L0 + (fabs(error.V) + fabs(error.W)) / Vi;
    worst /= tolerance;
    if (worst == 0.0) return GREATEST_CHANGE;
    if (!(worst < INFINITY)) return LEAST_CHANGE;
    return least(greatest(SAFETY / sqrt(sqrt(worst)), LEAST_CHANGE), GREATEST_CHANGE);
}

__attribute__((flatten)) static Run run(Parameters p, double Vi, double dt, double V_arrest, long max_steps,
                                        double tolerance) {
    p = with_intact_strength(p);
    bool fixed = dt > 0.0;
    double t = 0.0, length = fixed ? dt : FIRST_STEP * p.D0 / Vi, x;
    State y = {0.0, p.L0, Vi, 0.0, 0.0};
    Stage s = first_stage(y, p);
    State k = rates(y, s, p);
    Margins g = event_functions(t, y, s, p, V_arrest);
    int outcome = Vi >= V_arrest ? RUNNING : STOPPED;
    long steps = 0;
    for (; outcome == RUNNING; steps++) {
        if (steps == max_steps) return (Run){UNRESOLVED, t, y, steps, 0.0};
        Step tried = step(t, y, k, s, p, length);
        if (!fixed) {
            double change = allowed_change(tried.error, p, Vi, tolerance);
            length *= change;
            if (change < SAFETY) continue;
        }
        Margins g_end = event_functions(t + tried.dt, tried.y_end, s, p, V_arrest);
        int event = first_event(tried, g, g_end, s, p, V_arrest, &x);
        t += x * tried.dt;
        if (fixed) length = event >= 0 && x < 1.0 ? (1.0 - x) * tried.dt : dt;
        if (event < 0) y = tried.y_end, k = tried.k_end, g = g_end;
        else {
            y = state_within(y, k, tried.y_end, tried.k_end, tried.dt, x);
            outcome = after_event(event, &y, &s, p);
            k = rates(y, s, p), g = event_functions(t, y, s, p, V_arrest);
        }
    }
    return (Run){outcome, t, y, steps, s.eroding || s.penetrated ? 0.0 : k.V};
}

/* the bound of search.py */
static const double ALLOWANCE = 0.01;

static double least_energy_of_plate(Parameters p) {
    double plug = p.Hb;
    if (8.0 * p.tau * p.Hb > p.YB * p.D0) plug = p.YB * p.D0 / (8.0 * p.tau);
    return p.YB * (p.Hb - plug) + 4.0 * p.tau / p.D0 * plug * plug;
}

static double least_energy(Parameters p, double V) {
    double plate = least_energy_of_plate(p);
    if (p.Hc0 <= 0.0) return plate;
    double areal_mass = p.rho_p * p.L0 + p.rho_B * p.Hb + p.rho_c * p.Hc0;
    double rate = 2.0 * p.Yc0 / (areal_mass * V * V);
    double whole = shear_force_whole_plate(sheared_diameter(p.shear_law, p.D0, p.Hc0), p.tau, p.Hb);
    double most = least(whole / 3.0, shear_force_whole_plate(p.D0, p.tau, p.Hb)) / cross_section(p.D0);
    double knee = most / rate;
    if (plate >= knee) return plate + most * p.Hc0;
    double depth = log(knee / plate) / rate;
    return depth >= p.Hc0 ? plate * exp(rate * p.Hc0) : knee + most * (p.Hc0 - depth);
}

static bool may_perforate(Parameters p, double V) {
    if (2.0 * p.Yp / p.rho_p < V * V) return true;
    return 0.5 * p.rho_p * p.L0 * V * V * (1.0 + ALLOWANCE) > least_energy(with_intact_strength(p), V);
}

/* search.py */
static const double ROUGH = 1e-4, ROUGH_ERROR = 1e-3, ROUGH_WIDTH = 1.0, SMALL = 1e-14;
typedef struct { double V_arrest, dt; long max_steps; double tolerance; } Solver;
typedef struct { double V; bool perforated, resolved; double f; } Impact;
typedef struct { double low, high; long runs; bool resolved; } SearchResult;

static double residual_energy(Run end, Parameters p, double V, double V_arrest) {
    double f = end.y.V * end.y.V - V_arrest * V_arrest, left = p.Hc0 + p.Hb - end.y.Z;
    if (end.outcome == PERFORATED) return greatest(f, 0.0);
    if (end.constant_dV < 0.0) return least(f + 2.0 * end.constant_dV * left, -SMALL * V * V);
    return -V * V * greatest(left / (p.Hc0 + p.Hb), 1e-3);
}

static Impact impact(Parameters p, double V, Solver solver) {
    Run end = run(p, V, solver.dt, solver.V_arrest, solver.max_steps, solver.tolerance);
    bool perforated = end.outcome == PERFORATED, resolved = end.outcome != UNRESOLVED;
    return (Impact){V, perforated, resolved, residual_energy(end, p, V, solver.V_arrest)};
}

static long first_scanned(Parameters p, const double *velocities, long n) {
    long i = 0;
    if (p.drive_law == INTERFACE) return i;
    while (i + 1 < n && !may_perforate(p, velocities[i + 1])) i++;
    return i;
}

static SearchResult narrowed_change(Parameters p, Impact below, Impact above, double tolerance, Solver solver) {
    long runs = 0;
    Bracket b = bracket(above.V * above.V, above.f, below.V * below.V, below.f);
    while (fabs(b.x2 - b.x1) > 2.0 * below.V * tolerance && runs < MOST_TRIALS) {
        Impact tried = impact(p, sqrt(next_point(b, 1.9 * below.V * tolerance)), solver);
        runs++;
        if (!tried.resolved) return (SearchResult){tried.V, tried.V, runs, false};
        b = narrowed(b, tried.V * tried.V, tried.f);
    }
    return (SearchResult){sqrt(least(b.x1, b.x2)), sqrt(greatest(b.x1, b.x2)), runs, true};
}

static SearchResult with_runs(long runs, SearchResult found) {
    found.runs += runs;
    return found;
}

static SearchResult scanned_limit(Parameters p, const double *velocities, long n, double tolerance, Solver solver) {
    const long first = first_scanned(p, velocities, n);
    Impact below = {-INFINITY, false, true, 0.0};
    for (long i = first; i < n; i++) {
        Impact above = impact(p, velocities[i], solver);
        long runs = i - first + 1;
        if (!above.resolved) return (SearchResult){above.V, above.V, runs, false};
        if (above.perforated) {
            if (i == 0) return (SearchResult){-INFINITY, above.V, runs, true};
            if (i == first) below = impact(p, velocities[i - 1], solver);
            return with_runs(runs, narrowed_change(p, below, above, tolerance, solver));
        }
        below = above;
    }
    return (SearchResult){below.V, INFINITY, n - first, true};
}

static SearchResult find_ballistic_limit(Parameters p, const double *velocities, long n, double tolerance,
                                         Solver solver) {
    const Solver roughly = {solver.V_arrest, solver.dt, solver.max_steps, ROUGH};
    SearchResult rough = scanned_limit(p, velocities, n, ROUGH_WIDTH, roughly);
    long runs = rough.runs;
    if (rough.resolved && -INFINITY < rough.low && rough.high < INFINITY) {
        Impact below = impact(p, rough.low * (1.0 - ROUGH_ERROR), solver);
        Impact above = impact(p, rough.high * (1.0 + ROUGH_ERROR), solver);
        runs += 2;
        if (below.resolved && above.resolved && above.perforated && !below.perforated)
            return with_runs(runs, narrowed_change(p, below, above, tolerance, solver));
    }
    return with_runs(runs, scanned_limit(p, velocities, n, tolerance, solver));
}

/* kernels.py, of n rows */
void impacts(const Parameters *rows, const double *velocities, long n, double V_arrest, double dt, long max_steps,
             long (*counts)[2], double (*ends)[6]) {
    for (long i = 0; i < n; i++) {
        Run end = run(rows[i], velocities[i], dt, V_arrest, max_steps, TOLERANCE);
        counts[i][0] = end.outcome, counts[i][1] = end.steps;
        ends[i][0] = end.t;
        *(State *)(ends[i] + 1) = end.y;
    }
}

void ballistic_limits(const Parameters *rows, long n, const double *velocities, long points, double tolerance,
                      double V_arrest, double dt, long max_steps, long (*counts)[2], double (*ends)[2]) {
    const Solver solver = {V_arrest, dt, max_steps, TOLERANCE};
    for (long i = 0; i < n; i++) {
        SearchResult found = find_ballistic_limit(rows[i], velocities, points, tolerance, solver);
        counts[i][0] = found.runs, counts[i][1] = found.resolved;
        ends[i][0] = found.low, ends[i][1] = found.high;
    }
}
