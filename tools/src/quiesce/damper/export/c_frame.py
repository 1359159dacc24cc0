"""What every exported C model is made of around its equations: coil, rig, steps of integration."""

from collections.abc import Mapping

from quiesce.damper.export.c_names import as_comment, facts, filled, literal
from quiesce.damper.model_file import DamperModel

SOURCE = """/* Made by 'quiesce identify export'. C11, needs libm and nothing else.
$FACTS */
#include "$NAME.h"

$CORE#include <math.h>
#include <stdint.h>
#include <string.h>

/* Around the model: the coil's lag, and what the rig added. */
static const double rise_s = $RISE;
static const double fall_s = $FALL;
static const double inertia_kg = $INERTIA;
static const double skew_s = $SKEW;
static const double offset_N = $OFFSET;
static const double drift_N_s = $DRIFT;

/* Displacement in m, its derivatives, and the command: after the coil's lag in what the model sees,
 * as it is asked for in what the caller says. */
typedef struct {
    double x;
    double v;
    double a;
    double i;
} motion;

$MODEL
static motion seen(const motion *said, double current_A) {
    const motion out = {said->x - skew_s * said->v, said->v - skew_s * said->a, said->a, current_A};
    return out;
}

static double lagged(double from_A, double to_A, double step_s, double current_A) {
    const double target_A = 0.5 * (from_A + to_A);
    const double time_s = target_A > current_A ? rise_s : fall_s;
    if (!(time_s > 1e-9)) {
        return to_A;
    }
    return target_A + (current_A - target_A) * $EXP(-step_s / time_s);
}

$ADVANCE
void $NAME_reset($NAME_state *state) {
    const $NAME_state zero = {{0.0}, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0};
    *state = zero;
}

double $NAME_step($NAME_state *state, double x_m, double v_m_s, double a_m_s2, double command_A,
                  double dt_s) {
    const motion now = {x_m, v_m_s, a_m_s2, command_A};
    if (state->is_started != 0) {
        const motion last = {state->x_m, state->v_m_s, state->a_m_s2, state->command_A};
        advance(state, &last, &now, dt_s);
        state->elapsed_s += dt_s;
    } else {
        state->current_A = command_A;
        state->is_started = 1;
    }
    state->x_m = x_m;
    state->v_m_s = v_m_s;
    state->a_m_s2 = a_m_s2;
    state->command_A = command_A;
    const motion at = seen(&now, state->current_A);
    double rates[$NAME_STATES];
    return model_N(&at, state->z, rates) + inertia_kg * a_m_s2 + offset_N +
           drift_N_s * state->elapsed_s;
}
"""

# Without states only the coil has a memory.
COIL_ONLY = """static void advance($NAME_state *state, const motion *from, const motion *to,
                    double dt_s) {
    state->current_A = lagged(from->i, to->i, dt_s, state->current_A);
}
"""

# As the library: one step, its middle is where the lag of a half step ends.
COIL_IN_HALVES = """static void advance($NAME_state *state, const motion *from, const motion *to,
                    double dt_s) {
    const double middle_A = from->i + 0.5 * (to->i - from->i);
    const double lagged_A = lagged(from->i, middle_A, 0.5 * dt_s, state->current_A);
    state->current_A = lagged(middle_A, to->i, 0.5 * dt_s, lagged_A);
}
"""

RUNGE_KUTTA = """/* Part of the way u between two calls. */
static double cubic(double from, double slope_from, double to, double slope_to, double width,
                    double u) {
    const double rise = to - from;
    const double a = slope_from * width - rise;
    const double b = rise - slope_to * width;
    return from + u * rise + u * (1.0 - u) * ((1.0 - u) * a + u * b);
}

static motion between(const motion *from, const motion *to, double dt_s, int half, int halves) {
    if (half == halves) {
        return *to;
    }
    const double u = (double)half / (double)halves;
    const motion out = {cubic(from->x, from->v, to->x, to->v, dt_s, u),
                        cubic(from->v, from->a, to->v, to->a, dt_s, u),
                        from->a + u * (to->a - from->a), from->i + u * (to->i - from->i)};
    return out;
}

static void rates_at(const motion *said, double current_A, const double *z, const double *slope,
                     double step_s, double *rates) {
    const motion at = seen(said, current_A);
    double moved[$NAME_STATES];
    for (int k = 0; k < $NAME_STATES; ++k) {
        moved[k] = z[k] + step_s * slope[k];
    }
    (void)model_N(&at, moved, rates);
}

/* Classical Runge-Kutta. */
static void runge_kutta($NAME_state *state, const motion *from, const motion *middle,
                        const motion *to, double step_s) {
    const double half_s = 0.5 * step_s;
    $CURRENTS
    double *z = state->z;
    double k1[$NAME_STATES] = {0.0};
    double k2[$NAME_STATES];
    double k3[$NAME_STATES];
    double k4[$NAME_STATES];
    rates_at(from, state->current_A, z, k1, 0.0, k1);
    rates_at(middle, middle_A, z, k1, half_s, k2);
    rates_at(middle, middle_A, z, k2, half_s, k3);
    rates_at(to, end_A, z, k3, step_s, k4);
    const double sixth_s = step_s / 6.0;
    for (int k = 0; k < $NAME_STATES; ++k) {
        z[k] = z[k] + sixth_s * (k1[k] + 2.0 * (k2[k] + k3[k]) + k4[k]);
    }
    state->current_A = end_A;
}

/* As many steps as the fastest state asks for, at either command; stable up to 2.78 of its time
 * constant, and one is accurate. */
static int steps_for(double one_A, double other_A, double dt_s) {
    const double steps = ceil(fmax(fastest_1_s(one_A), fastest_1_s(other_A)) * dt_s);
    return steps > 1.0 ? (int)fmin(steps, 2000.0) : 1;
}

static void advance($NAME_state *state, const motion *said, const motion *now, double dt_s) {
    $ENDS
    const int count = steps_for(last.i, next.i, dt_s);
    for (int k = 0; k < count; ++k) {
        const motion from = between(&last, &next, dt_s, 2 * k, 2 * count);
        const motion middle = between(&last, &next, dt_s, 2 * k + 1, 2 * count);
        const motion to = between(&last, &next, dt_s, 2 * k + 2, 2 * count);
        runge_kutta(state, &from, &middle, &to, dt_s / count);
    }
}
"""

# The coil lags within each step.
RUNGE_KUTTA_WITH_COIL = filled(
    RUNGE_KUTTA,
    {
        "$CURRENTS": """const double said_A = state->current_A;
    const double middle_A = lagged(from->i, middle->i, half_s, said_A);
    const double end_A = lagged(middle->i, to->i, half_s, middle_A);""",
        "$ENDS": """const motion last = *said;
    const motion next = *now;""",
    },
)

# The coil's current runs straight from what it was to what it is.
RUNGE_KUTTA_ON_COIL = filled(
    RUNGE_KUTTA,
    {
        "$CURRENTS": """const double middle_A = middle->i;
    const double end_A = to->i;""",
        "$ENDS": """const motion last = {said->x, said->v, said->a, state->current_A};
    const double coil_A = lagged(said->i, now->i, dt_s, state->current_A);
    const motion next = {now->x, now->v, now->a, coil_A};""",
    },
)


def framed(
    name: str,
    damper: DamperModel,
    title: str,
    rig: Mapping[str, float],
    with_rig: bool,
    model: str,
    advance: str,
    exp: str = "exp",
    core: str = "",
) -> str:
    """The source.

    model: text that has double model_N(const motion *, const double *z, double *rates), and where
    it has states double fastest_1_s(double current_A). exp: for the coil's lag. core: a header
    beside the source.
    """
    return filled(
        SOURCE,
        {
            "$FACTS": as_comment(facts(damper, title, with_rig), " *"),
            "$RISE": literal(rig["rise_s"]),
            "$FALL": literal(rig["fall_s"]),
            "$INERTIA": literal(rig["inertia_kg"]),
            "$SKEW": literal(rig["skew_s"]),
            "$OFFSET": literal(rig["offset_N"]),
            "$DRIFT": literal(rig["drift_N_s"]),
            "$CORE": f'#include "{core}"\n\n' if core else "",
            "$MODEL": model,
            "$ADVANCE": advance,
            "$EXP": exp,
            "$NAME": name,
        },
    )
