"""Learned models with a memory as C: sampled networks, and networks over hysteresis elements."""

from collections.abc import Mapping, Sequence
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.damper.export.c_names import literal, literals
from quiesce.damper.export.graph import equations
from quiesce.damper.export.kernel_c import model_text
from quiesce.damper.export.laws import field_of, laws_of
from quiesce.damper.export.learned_parts import (
    Part,
    array,
    inputs_of,
    layers_text,
    ranges_text,
    said_text,
)
from quiesce.damper.library import FIELD, models
from quiesce.damper.model_file import DamperModel

SAMPLED = """
static void take_sample(const motion *m, double *z) {
    const double picked[INPUTS] = {$SAID};
    double room[$ROOM];
    quiesce_sampled_take(&model, picked, m->x, m->v, z, room);
}

static double model_N(const motion *m, const double *z, double *rates) {
    (void)rates;
    if (z[quiesce_sampled_started] > 0.0) {
        return z[quiesce_sampled_held];
    }
    /* Nothing has been sampled yet: rest before now. */
    double first[$STATES];
    memcpy(first, z, sizeof first);
    take_sample(m, first);
    return first[quiesce_sampled_held];
}
"""

SAMPLED_ADVANCE = """static void advance($NAME_state *state, const motion *from, const motion *to,
                    double dt_s) {
    state->current_A = lagged(from->i, to->i, dt_s, state->current_A);
    if (quiesce_sampled_is_due(model.sample_time_s, dt_s, state->z)) {
        const motion at = seen(to, state->current_A);
        take_sample(&at, state->z);
    }
}
"""


def sampled_part(keys: Mapping[str, Any]) -> Part:
    inputs = inputs_of(keys)
    lags, feedback = list(keys["lags"]), list(keys.get("feedback", []))
    quadrature = keys.get("quadrature")
    width = len(inputs) + (4 if quadrature else 0)
    taken = len(lags) * width + len(feedback)
    states = 3 + (2 if quadrature else 0) + (lags[-1] + 1) * width + max([0, *feedback])
    layers = layers_text("layers", keys["layer"], taken)
    names = ("window_s", "envelope_m", "lowest_rad_s", "highest_rad_s")
    swing = f"{{{literals(quadrature[key] for key in names)}}}" if quadrature else ""
    text = f"""{ranges_text(keys, inputs)}
{layers.text}
static const int lags[{len(lags)}] = {{{", ".join(map(str, lags))}}};
"""
    if feedback:
        text += (
            f"static const int feedback[{len(feedback)}] = {{{', '.join(map(str, feedback))}}};\n"
        )
    if quadrature:
        text += f"static const struct quiesce_quadrature quadrature = {swing};\n"
    text += f"""static const struct quiesce_sampled model = {{
    {literal(keys["sample_time_s"])}, {literal(keys["force_scale_N"])}, INPUTS, low, high,
    lags, {len(lags)}, {"feedback" if feedback else "NULL"}, {len(feedback)},
    {"&quadrature" if quadrature else "NULL"}, layers, {layers.count}, {layers.widest}}};
"""
    body = SAMPLED.replace("$SAID", said_text(inputs)).replace("$STATES", str(states))
    text += body.replace("$ROOM", str(taken + 2 * layers.widest))
    return Part(text, ("sampled_network",), states, advance=SAMPLED_ADVANCE)


ELEMENTS = ("coil_times_s", "elastic_times_s", "chain_times_s", "stop_reaches_m")

HYSTERESIS = """
static double model_N(const motion *m, const double *z, double *rates) {
    quiesce_hysteresis_rates(&model, m->v, m->i, z, rates);
    const double current_A = quiesce_hysteresis_current_A(&model, m->i, z);
    $BASE
    const double moved[] = {m->x, m->v, m->a};
    double features[$FEATURES];
    quiesce_hysteresis_features(&model, moved, from_base_N, z, features);
    double room[$ROOM];
    return from_base_N + quiesce_hysteresis_added_N(&model, features, current_A, room);
}

/* Bound of how fast the states change, in 1/s. */
static double fastest_1_s(double current_A) {
    $FASTEST
}
"""

BASE = """const motion under = {m->x, m->v, m->a, current_A};
    const double from_base_N = base_N(&under, z + OWN_STATES, rates + OWN_STATES);"""


def hysteresis_part(damper: DamperModel) -> Part:
    keys = damper.parameters
    base = base_of(keys)
    one = equations()[base.model] if base else None
    own = sum(len(keys.get(name, [])) for name in ELEMENTS)
    known = models().get(base.model) if base else None
    text = f"enum {{ OWN_STATES = {own} }};\n"
    if base and one:
        kernel = model_text(one, laws_of(base), field_of(base), base.speed_m_s, set())
        text += kernel.replace("model_N(", "base_N(").replace("fastest_1_s(", "base_fastest_1_s(")
    tables, room = hysteresis_tables(keys, own, base is not None)
    body = HYSTERESIS.replace("$BASE", BASE if base else "const double from_base_N = 0.0;")
    rates = [1.0 / time_s for time_s in times_of(keys)]
    rates += [damper.speed_m_s / reach_m for reach_m in keys.get("stop_reaches_m", [])]
    most = literal(max([0.0, *rates]))
    if one and one.rates:
        fastest = f"return fmax({most}, base_fastest_1_s(current_A));"
    else:
        fastest = f"(void)current_A;\n    return {most};"
    body = body.replace("$FASTEST", fastest).replace("$ROOM", str(room))
    body = body.replace("$FEATURES", str(len(keys["feature_means"])))
    states = own + (len(one.rates) if one else 0)
    uses_accel = bool(keys.get("uses_accel")) or bool(known and known.uses_accel)
    return Part(text + tables + body, ("hysteresis_network",), states, states > 0, uses_accel)


def times_of(keys: Mapping[str, Any]) -> list[float]:
    names = ("coil_times_s", "coil_fall_times_s", "elastic_times_s", "chain_times_s")
    return [time_s for name in names for time_s in keys.get(name, [])]


def base_of(keys: Mapping[str, Any]) -> DamperModel | None:
    """The model that the network stands on. UsageError where it is a learned one, too."""
    table = keys.get("base")
    if table is None:
        return None
    if table["model"] not in equations():
        raise UsageError(
            f"a network on a model {table['model']} has no C form; --to mat takes any model"
        )
    law = table.get("field", {})
    rig = {
        name: float(law[key])
        for key, name in zip(("exponent", "saturation", "reference_A"), FIELD, strict=True)
        if key in law
    }
    parameters = table.get("parameters")
    if parameters is None:
        skipped = ("model", "stroke_m", "speed_m_s", "field")
        parameters = {key: value for key, value in table.items() if key not in skipped}
    return DamperModel(
        "base", table["model"], float(table.get("stroke_m", 0.0)),
        float(table.get("speed_m_s", 0.0)), parameters, rig,
    )  # fmt: skip


def hysteresis_tables(keys: Mapping[str, Any], own: int, has_base: bool) -> tuple[str, int]:
    """The tables, and the room that the networks need."""
    falls = keys.get("coil_fall_times_s", keys.get("coil_times_s", []))
    given = {name: keys.get(name, []) for name in ELEMENTS} | {"coil_fall_times_s": falls}
    features, heads = len(keys["feature_means"]), int(keys["field_order"]) + 1
    members = [
        layers_text(f"member{k}", member["layer"], features)
        for k, member in enumerate(keys["member"])
    ]
    widest = max(one.widest for one in members)
    texts = [array(name, values) for name, values in given.items() if len(values)]
    texts += [
        array("means", keys["feature_means"]),
        array("scales", keys["feature_scales"]),
        array("skip", keys["skip"]),
        *(one.text for one in members),
        f"static const struct quiesce_layer *const members[] = {{{named('member', members)}}};",
        f"static const int counts[] = {{{', '.join(str(one.count) for one in members)}}};",
    ]
    elements = "\n    ".join(
        f"{len(given[name])}, {name if len(given[name]) else 'NULL'}," for name in ELEMENTS[1:]
    )
    coils = len(given["coil_times_s"])
    coil = "coil_times_s, coil_fall_times_s" if coils else "NULL, NULL"
    fields = (keys["force_scale_N"], keys["current_scale_A"], keys.get("field_exponent", 1.0),
              keys.get("saturation", 1e12), keys["clip"])  # fmt: skip
    texts.append(f"""static const struct quiesce_hysteresis model = {{
    {literals(fields)},
    {int(bool(keys.get("uses_accel")))}, {int(has_base)},
    {coils}, {coil},
    {elements}
    means, scales, skip, {features}, {heads}, members, counts, {len(members)}, {widest}}};
""")
    return "\n".join(texts), 2 * heads + 2 * widest


def named(prefix: str, members: Sequence[Any]) -> str:
    return ", ".join(f"{prefix}{k}" for k in range(len(members)))
