"""Learned models as plain C11: their numbers as tables, and the text that the library itself runs
(sim_hil/damper/learned/cores)."""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.damper.export.c_frame import COIL_ONLY, RUNGE_KUTTA_ON_COIL, framed
from quiesce.damper.export.c_names import (
    CSource,
    core_name,
    filled,
    header_text,
    literal,
    literals,
    rig_values,
)
from quiesce.damper.export.learned_parts import Part, array, box_text, inputs_of, layers_text
from quiesce.damper.export.learned_states import hysteresis_part, sampled_part
from quiesce.damper.model_file import DamperModel

TITLES = {
    "anfis": "ANFIS, product and weighted mean",
    "feed_forward_network": "feed-forward network",
    "hilbert_network": "network over envelope, frequency and phase",
    "hysteresis_network": "network over hysteresis elements",
    "neuro_fuzzy_stf": "self-tuning fuzzy model, frozen",
    "recurrent_network": "recurrent network",
    "support_vector": "support-vector regression",
    "ts_fuzzy": "Takagi-Sugeno clusters",
}
_INCLUDE = re.compile(r'^#include "([^"]+)"\n', re.MULTILINE)

STATIC = """static double model_N(const motion *m, const double *z, double *rates) {
    (void)z;
    (void)rates;
$BODY
}
"""


def learned_source(name: str, damper: DamperModel, with_rig: bool) -> CSource:
    """The texts of NAME.h, NAME.c and NAME_core.h. UsageError for what has no C form."""
    if "temperature_C" in damper.parameters:
        raise UsageError("a model with the temperature as input has no C form; use --to mat")
    part = part_of(damper)
    title, rig = TITLES[damper.model], rig_values(damper, with_rig)
    advance = part.advance or (RUNGE_KUTTA_ON_COIL if part.has_rates else COIL_ONLY)
    source = framed(name, damper, title, rig, with_rig, part.text, advance, core=core_name(name))
    header = header_text(name, damper, title, max(1, part.states), part.uses_accel, with_rig)
    return CSource(header, source, core_text(name, part.cores))


def part_of(damper: DamperModel) -> Part:
    keys = damper.parameters
    if damper.model == "hysteresis_network":
        return hysteresis_part(damper)
    if damper.model in ("hilbert_network", "recurrent_network") or "lags" in keys:
        return sampled_part(keys)
    writers: dict[str, Callable[[Mapping[str, Any], Sequence[str]], tuple[str, str]]] = {
        "anfis": anfis_text,
        "feed_forward_network": network_text,
        "neuro_fuzzy_stf": stf_text,
        "support_vector": vectors_text,
        "ts_fuzzy": clusters_text,
    }
    tables, body = writers[damper.model](keys, inputs_of(keys))
    core = {"feed_forward_network": "network"}.get(damper.model, damper.model)
    return Part(tables + "\n" + filled(STATIC, {"$BODY": body}), ("input_box", core))


def core_text(name: str, cores: Sequence[str]) -> str:
    """These headers and those that they include, each once, as one."""
    folder = root() / "sim_hil/damper/learned/cores"
    parts: list[str] = []
    seen: set[str] = set()

    def add(file: Path) -> None:
        if file.name in seen:
            return
        seen.add(file.name)
        if not file.is_file():
            raise UsageError(f"{file} is not there; export needs it (QUIESCE_ROOT)")
        text = file.read_text(encoding="utf-8")
        for included in _INCLUDE.findall(text):
            add(folder / included)
        parts.append(_INCLUDE.sub("", text).strip() + "\n")

    for core in cores:
        add(folder / f"{core}_core.h")
    return f"/* Of {name}.c: what the Quiesce library itself runs. */\n\n" + "\n".join(parts)


def anfis_text(keys: Mapping[str, Any], inputs: Sequence[str]) -> tuple[str, str]:
    counts = [len(keys[key]["centres"]) for key in inputs]
    tables = f"""{box_text(keys, inputs)}
static const int counts[INPUTS] = {{{", ".join(map(str, counts))}}};
{array("centres", np.concatenate([keys[key]["centres"] for key in inputs]))}
{array("widths", np.concatenate([keys[key]["widths"] for key in inputs]))}
{array("consequents_N", keys["consequents_N"])}
static const struct quiesce_anfis model = {{INPUTS, counts, {int(np.prod(counts))}, centres, widths,
                                           consequents_N}};
"""
    return (
        tables,
        f"""    double u[INPUTS];
    clamped_inputs(m, u);
    double grades[{sum(counts)}];
    return quiesce_anfis_N(&model, u, grades);""",
    )


def network_text(keys: Mapping[str, Any], inputs: Sequence[str]) -> tuple[str, str]:
    layers = layers_text("layers", keys["layer"], len(inputs))
    tables = f"{box_text(keys, inputs, is_scaled=True)}\n{layers.text}"
    return (
        tables,
        f"""    double u[INPUTS];
    scaled_inputs(m, u);
    double hidden[{2 * layers.widest}];
    double out;
    quiesce_network_run(layers, {layers.count}, u, &out, hidden, {layers.widest});
    return {literal(keys["force_scale_N"])} * out;""",
    )


def vectors_text(keys: Mapping[str, Any], inputs: Sequence[str]) -> tuple[str, str]:
    tables = f"""{box_text(keys, inputs, is_scaled=True)}
{array("coefficients", keys["coefficients"])}
{array("support_vectors", keys["support_vectors"])}
static const struct quiesce_support_vector model = {{
    INPUTS, {len(keys["coefficients"])}, {literal(keys["force_scale_N"])},
    {literal(keys["gamma"])}, {literal(keys["intercept"])}, coefficients, support_vectors}};
"""
    return (
        tables,
        """    double u[INPUTS];
    scaled_inputs(m, u);
    return quiesce_support_vector_N(&model, u);""",
    )


def clusters_text(keys: Mapping[str, Any], inputs: Sequence[str]) -> tuple[str, str]:
    rules = keys["rule"]
    arrays = "\n".join(
        array(name, np.concatenate([one[key] for one in rules]))
        for name, key in (("centres", "centre"), ("widths", "width"), ("gains_N", "gain_N"))
    )
    tables = f"""{box_text(keys, inputs, is_scaled=True)}
{arrays}
{array("offsets_N", [one["offset_N"] for one in rules])}
static const struct quiesce_ts_fuzzy model = {{INPUTS, {len(rules)}, centres, widths, gains_N,
                                              offsets_N}};
"""
    return (
        tables,
        """    double u[INPUTS];
    scaled_inputs(m, u);
    return quiesce_ts_fuzzy_N(&model, u);""",
    )


def stf_text(keys: Mapping[str, Any], _inputs: Sequence[str]) -> tuple[str, str]:
    scales = [keys[name] for name in ("force_scale_N", "disp_scale_m", "velocity_scale_m_s")]
    sets = ",\n    ".join(
        f"{{{{{literals(keys[key]['centres'])}}}, {{{literals(keys[key]['bases'])}}}}}"
        for key in ("displacement", "velocity", "current")
    )
    tables = f"""static const struct quiesce_stf model = {{
    {literals([*scales, keys["current_scale_A"]])}, {int(keys["conjunction"] == "minimum")},
    {sets},
    {{{literals(keys["outputs"])}}},
    {{{literals(keys["gains"])}}},
    {{{", ".join(str(int(label)) for label in keys["rules"])}}},
}};
"""
    return tables, "    return quiesce_stf_N(&model, m->i, m->x, m->v);"
