"""Learned models without memory as plain C11: loops over tables."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.export.c_names import (
    CSource,
    as_comment,
    facts,
    filled,
    header_text,
    literal,
    literals,
    rig_values,
)
from quiesce.damper.model_file import DamperModel

TITLES = {
    "anfis": "ANFIS, product and weighted mean",
    "feed_forward_network": "feed-forward network",
    "support_vector": "support-vector regression",
}
# In the order in which models have them, and what of the call each is.
_INPUTS = {"current_A": "current_A", "displacement_m": "x", "velocity_m_s": "v"}

SOURCE = """/* Made by 'quiesce identify export'. C11 (and C++):
 *   cc -std=c11 -O2 -c $NAME.c    (link with -lm)
$FACTS */
#include "$NAME.h"

#include <math.h>

enum { INPUTS = $INPUTS };

static const double kLow[INPUTS] = {$LOW};
static const double kHigh[INPUTS] = {$HIGH};
static const double kRise_s = $RISE;
static const double kFall_s = $FALL;
static const double kInertia_kg = $INERTIA;
static const double kSkew_s = $SKEW;
static const double kOffset_N = $OFFSET;
static const double kDrift_N_s = $DRIFT;

static double clamped(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

$MODEL
static double lagged(double from_A, double to_A, double dt_s, double current_A) {
    const double target_A = 0.5 * (from_A + to_A);
    const double time_s = target_A > current_A ? kRise_s : kFall_s;
    if (!(time_s > 1e-9)) {
        return to_A;
    }
    return target_A + (current_A - target_A) * exp(-dt_s / time_s);
}

void $NAME_reset($NAME_state *state) {
    const $NAME_state zero = {{0.0}, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0};
    *state = zero;
}

double $NAME_step($NAME_state *state, double x_m, double v_m_s, double a_m_s2, double command_A,
                  double dt_s) {
    if (state->is_started != 0) {
        state->current_A = lagged(state->command_A, command_A, dt_s, state->current_A);
        state->elapsed_s += dt_s;
    } else {
        state->current_A = command_A;
        state->is_started = 1;
    }
    state->x_m = x_m;
    state->v_m_s = v_m_s;
    state->a_m_s2 = a_m_s2;
    state->command_A = command_A;
    const double x = x_m - kSkew_s * v_m_s;
    const double v = v_m_s - kSkew_s * a_m_s2;
    const double current_A = state->current_A;
    (void)x;
    (void)v;
    (void)current_A;
    const double seen[INPUTS] = {$SEEN};
    double u[INPUTS];
    for (int k = 0; k < INPUTS; ++k) {
        u[k] = clamped(seen[k], kLow[k], kHigh[k]);
    }
    return model_N(u) + kInertia_kg * a_m_s2 + kOffset_N + kDrift_N_s * state->elapsed_s;
}
"""

SCALED = """    double s[INPUTS];
    for (int k = 0; k < INPUTS; ++k) {
        s[k] = 2.0 * ((u[k] - kLow[k]) / (kHigh[k] - kLow[k])) - 1.0;
    }
"""


def learned_source(name: str, damper: DamperModel, with_rig: bool) -> CSource:
    """The texts of NAME.h and NAME.c. UsageError for models that cannot be exported so."""
    if damper.model not in TITLES or "lags" in damper.parameters:
        raise UsageError(
            f"model {damper.model}{' with delays' if damper.model in TITLES else ''} has no C form "
            f"yet (those of equations and {', '.join(TITLES)} without delays have); --to mat takes "
            "any model"
        )
    keys = damper.parameters
    if "temperature_C" in keys:
        raise UsageError("a model with the temperature as input has no C form yet; use --to mat")
    inputs = [key for key in _INPUTS if key in keys]
    writers = {"anfis": anfis_text, "feed_forward_network": network_text}
    model = writers.get(damper.model, vectors_text)(keys, inputs)
    rig, title = rig_values(damper, with_rig), TITLES[damper.model]
    fields = {
        "$FACTS": as_comment(facts(damper, title, with_rig), " *"),
        "$INPUTS": str(len(inputs)),
        "$LOW": literals(keys[key]["range"][0] for key in inputs),
        "$HIGH": literals(keys[key]["range"][1] for key in inputs),
        "$RISE": literal(rig["rise_s"]),
        "$FALL": literal(rig["fall_s"]),
        "$INERTIA": literal(rig["inertia_kg"]),
        "$SKEW": literal(rig["skew_s"]),
        "$OFFSET": literal(rig["offset_N"]),
        "$DRIFT": literal(rig["drift_N_s"]),
        "$SEEN": ", ".join(_INPUTS[key] for key in inputs),
        "$MODEL": model,
        "$NAME": name,
    }
    header = header_text(name, damper, title, 1, False, with_rig)
    return CSource(header, filled(SOURCE, fields), ".c")


def array(name: str, values: Sequence[float] | np.ndarray) -> str:
    numbers = [literal(value) for value in np.ravel(np.asarray(values, dtype=float))]
    lines = [", ".join(numbers[k : k + 6]) for k in range(0, len(numbers), 6)]
    body = ",\n    ".join(lines)
    return f"static const double {name}[{len(numbers)}] = {{\n    {body},\n}};\n"


def anfis_text(keys: Mapping[str, Any], inputs: Sequence[str]) -> str:
    counts = [len(keys[key]["centres"]) for key in inputs]
    firsts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    return f"""enum {{ RULES = {int(np.prod(counts))} }};
static const int kCounts[INPUTS] = {{{", ".join(map(str, counts))}}};
static const int kFirsts[INPUTS] = {{{", ".join(str(int(k)) for k in firsts)}}};
{array("kCentres", np.concatenate([keys[key]["centres"] for key in inputs]))}
{array("kWidths", np.concatenate([keys[key]["widths"] for key in inputs]))}
{array("kConsequents_N", keys["consequents_N"])}
static double exponent(int k, int j, double value) {{
    const double distance = (value - kCentres[kFirsts[k] + j]) / kWidths[kFirsts[k] + j];
    return -0.5 * distance * distance;
}}

/* Weights are relative to the strongest rule, so that their sum does not vanish. */
static double model_N(const double *u) {{
    double nearest[INPUTS];
    for (int k = 0; k < INPUTS; ++k) {{
        nearest[k] = exponent(k, 0, u[k]);
        for (int j = 1; j < kCounts[k]; ++j) {{
            nearest[k] = fmax(nearest[k], exponent(k, j, u[k]));
        }}
    }}
    double sum = 0.0;
    double moment = 0.0;
    for (int rule = 0; rule < RULES; ++rule) {{
        double total = 0.0;
        int rest = rule;
        for (int k = INPUTS - 1; k >= 0; --k) {{
            total += exponent(k, rest % kCounts[k], u[k]) - nearest[k];
            rest /= kCounts[k];
        }}
        const double weight = exp(total);
        sum += weight;
        moment += weight * kConsequents_N[rule];
    }}
    return moment / sum;
}}
"""


def network_text(keys: Mapping[str, Any], inputs: Sequence[str]) -> str:
    layers = keys["layer"]
    units = [int(layer["units"]) for layer in layers]
    widest = max([*units, len(inputs)])
    tables = "\n".join(
        array(f"kWeights{k}", layer["weights"]) + array(f"kBiases{k}", layer["biases"])
        for k, layer in enumerate(layers)
    )
    calls = "\n".join(
        f"    layer(kWeights{k}, kBiases{k}, {before}, {count}, {int(k + 1 == len(layers))}, "
        f"{'s' if k == 0 else 'ab'[k % 2]}, {'ab'[(k + 1) % 2]});"
        for k, (before, count) in enumerate(zip([len(inputs), *units], units, strict=False))
    )
    spare = "    double a[WIDEST];\n" if len(layers) > 1 else ""
    return f"""enum {{ WIDEST = {widest} }};
{tables}
static void layer(const double *weights, const double *biases, int inputs, int units, int is_last,
                  const double *in, double *out) {{
    for (int j = 0; j < units; ++j) {{
        double sum = biases[j];
        for (int k = 0; k < inputs; ++k) {{
            sum += weights[j * inputs + k] * in[k];
        }}
        out[j] = is_last ? sum : tanh(sum);
    }}
}}

static double model_N(const double *u) {{
{SCALED}    double b[WIDEST];
{spare}{calls}
    return {literal(keys["force_scale_N"])} * {"ab"[len(layers) % 2]}[0];
}}
"""


def vectors_text(keys: Mapping[str, Any], inputs: Sequence[str]) -> str:
    coefficients = keys["coefficients"]
    return f"""enum {{ VECTORS = {len(coefficients)} }};
{array("kCoefficients", coefficients)}
{array("kVectors", keys["support_vectors"])}
static double model_N(const double *u) {{
{SCALED}    double sum = {literal(keys["intercept"])};
    for (int j = 0; j < VECTORS; ++j) {{
        double distance2 = 0.0;
        for (int k = 0; k < INPUTS; ++k) {{
            const double apart = s[k] - kVectors[j * INPUTS + k];
            distance2 += apart * apart;
        }}
        sum += kCoefficients[j] * exp(-{literal(keys["gamma"])} * distance2);
    }}
    return {literal(keys["force_scale_N"])} * sum;
}}
"""
