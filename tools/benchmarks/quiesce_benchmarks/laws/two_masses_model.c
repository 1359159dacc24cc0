// The rig of damper and elastomer in floating point, for a search over its numbers: three motions
// of the base, each uncontrolled, with the damper controlled, and with both. Lanes run side by
// side.
//
// Euler's method, the velocities' step implicit in all damping; the law at every `hold` steps, its
// currents a tick late and through the coils' lags, as on the bench, but without noise and with the
// exact inverse in place of a map.
#include <math.h>

enum { MOTIONS = 3, CONTROLS = 3, USED = MOTIONS * CONTROLS, LANES = 16 };

typedef struct {
    double lower_kg, upper_kg, spring_N_m, damping_N_s_m, ratio;
    double sky_N_s_m, limit_N, mount_N_s_m;
} rig_t;

// Kwok's damper; a spring whose stiffness is n0 + n1 i + n2 i^2.
typedef struct {
    double c0, c1, k0, k1, alpha0, alpha1, alpha2, beta, delta0, delta1, f0, f1, x_s, most_A, lag_s;
} damper_t;
typedef struct {
    double n0, n1, n2, loss_s, most_A, lag_s;
} mount_t;

typedef struct {
    double lower_m, lower_m_s, upper_m, upper_m_s;
    double damper_A, mount_A, wanted_damper_A, wanted_mount_A, next_damper_A, next_mount_A;
    double is_damper, is_mount, peak_m_s2, square_sum, stroke_m;
} lane_t;

static inline double clamp(double value, double low, double high) {
    value = value < low ? low : value;
    return value > high ? high : value;
}

// Within 1e-4.
static inline double fast_tanh(double x) {
    x = clamp(x, -4.97, 4.97);
    const double s = x * x;
    return x * (135135 + s * (17325 + s * (378 + s))) /
           (135135 + s * (62370 + s * (3150 + 28 * s)));
}

// The smaller root of a i^2 + b i = c, for b > 0.
static inline double current_of(double a, double b, double c, double most_A) {
    const double d = b * b + 4 * a * c;
    return clamp(2 * c / (b + sqrt(d > 0 ? d : 0)), 0, most_A);
}

static inline void control(lane_t *s, const rig_t *rig, const damper_t *d, const mount_t *m,
                           double base_m_s) {
    const double least_m_s = 0.006, least_m = 15e-6; // as the maps' first points
    s->wanted_damper_A = s->next_damper_A;
    s->wanted_mount_A = s->next_mount_A;
    const double force =
        clamp(rig->sky_N_s_m * (s->lower_m_s + base_m_s), -rig->limit_N, rig->limit_N);
    const double v = rig->ratio * s->lower_m_s;
    const double side = v > 0 ? 1 : -1;
    const double speed = fabs(v) > least_m_s ? fabs(v) : least_m_s;
    const double t = fast_tanh(d->beta * speed);
    const double missing = fabs(force) - d->c0 * speed - d->alpha0 * t - side * d->f0;
    const double i =
        current_of(d->alpha2 * t, d->c1 * speed + d->alpha1 * t + side * d->f1, missing, d->most_A);
    s->next_damper_A = force * v > 0 ? s->is_damper * i : 0;
    const double r = s->upper_m - s->lower_m;
    const double pull = rig->mount_N_s_m * (s->upper_m_s + base_m_s);
    const double size = fabs(r) > least_m ? fabs(r) : least_m;
    const double j = current_of(m->n2, m->n1, fabs(pull) / size - m->n0, m->most_A);
    s->next_mount_A = pull * r > 0 ? s->is_mount * j : 0;
}

static inline void step(lane_t *s, const rig_t *rig, const damper_t *d, const mount_t *m,
                        double base_m_s2, double dt, double damper_part, double mount_part,
                        double is_steady) {
    s->damper_A += damper_part * (s->wanted_damper_A - s->damper_A);
    s->mount_A += mount_part * (s->wanted_mount_A - s->mount_A);
    const double i = s->damper_A, j = s->mount_A, ratio = rig->ratio;
    const double k = m->n0 + m->n1 * j + m->n2 * j * j, kd = k * m->loss_s;
    const double pull = k * (s->upper_m - s->lower_m) + kd * (s->upper_m_s - s->lower_m_s);
    const double x = ratio * s->lower_m, v = ratio * s->lower_m_s, c = d->c0 + d->c1 * i;
    const double alpha = d->alpha0 + d->alpha1 * i + d->alpha2 * i * i;
    const double t = fast_tanh(d->beta * v + (d->delta0 + d->delta1 * i) * fast_tanh(x / d->x_s));
    const double force = ratio * (c * v + (d->k0 + d->k1 * i) * x + alpha * t + d->f0 + d->f1 * i);
    const double upper = -pull / rig->upper_kg - base_m_s2;
    const double lower =
        (-rig->spring_N_m * s->lower_m - rig->damping_N_s_m * s->lower_m_s - force + pull) /
            rig->lower_kg -
        base_m_s2;
    const double resists =
        rig->damping_N_s_m + ratio * ratio * (c + alpha * d->beta * (1 - t * t)) + kd;
    const double a = 1 + dt * resists / rig->lower_kg, b = dt * kd / rig->lower_kg;
    const double e = dt * kd / rig->upper_kg, det = a * (1 + e) - b * e;
    const double lower_now = ((1 + e) * lower + b * upper) / det;
    const double upper_now = (a * upper + e * lower) / det;
    s->lower_m_s += dt * lower_now;
    s->upper_m_s += dt * upper_now;
    s->lower_m += dt * s->lower_m_s;
    s->upper_m += dt * s->upper_m_s;
    const double felt = is_steady * fabs(upper_now + base_m_s2);
    s->peak_m_s2 = felt > s->peak_m_s2 ? felt : s->peak_m_s2;
    s->square_sum += felt * felt;
    const double r = fabs(s->upper_m - s->lower_m);
    s->stroke_m = r > s->stroke_m ? r : s->stroke_m;
}

// base: acceleration and velocity of each motion, [MOTIONS steps]. out: peak acceleration of the
// upper mass, its RMS, both from step `steady` on, and the mount's largest stroke, [3 USED].
void two_masses_run(const rig_t *rig, const damper_t *damper, const mount_t *mount,
                    const double *base_m_s2, const double *base_m_s, long steps, long steady,
                    double dt, long hold, double *out) {
    lane_t lanes[LANES] = {0};
    for (int i = 0; i < USED; i++) {
        lanes[i].is_damper = i % CONTROLS > 0;
        lanes[i].is_mount = i % CONTROLS > 1;
    }
    const double damper_part = 1 - exp(-dt / damper->lag_s),
                 mount_part = 1 - exp(-dt / mount->lag_s);
    for (long n = 0; n < steps; n++) {
        for (int i = 0; i < LANES; i++) {
            const long at = (i < USED ? i / CONTROLS : 0) * steps + n;
            if (n % hold == 0) {
                control(&lanes[i], rig, damper, mount, base_m_s[at]);
            }
            step(&lanes[i], rig, damper, mount, base_m_s2[at], dt, damper_part, mount_part,
                 n >= steady);
        }
    }
    for (int i = 0; i < USED; i++) {
        out[i] = lanes[i].peak_m_s2;
        out[USED + i] = sqrt(lanes[i].square_sum / (double)(steps - steady));
        out[2 * USED + i] = lanes[i].stroke_m;
    }
}
