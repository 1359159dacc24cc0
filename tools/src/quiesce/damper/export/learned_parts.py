"""Pieces of the C of learned models: tables, boxes of inputs, layers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.damper.export.c_names import literal, literals

# In the order in which models have them, and what of the call each is.
SEEN = {"current_A": "m->i", "displacement_m": "m->x", "velocity_m_s": "m->v"}


@dataclass(frozen=True)
class Part:
    """A model for c_frame.framed. text: tables and model_N; cores: what it needs of
    sim_hil/damper/learned/cores; has_rates: its states are integrated; advance: in place of the
    frame's."""

    text: str
    cores: tuple[str, ...]
    states: int = 0
    has_rates: bool = False
    uses_accel: bool = False
    advance: str = ""


@dataclass(frozen=True)
class Layers:
    """text: an array of struct quiesce_layer with all that it points to."""

    text: str
    count: int
    widest: int  # of the hidden ones, at least 1


def inputs_of(keys: Mapping[str, Any]) -> list[str]:
    return [key for key in SEEN if key in keys]


def array(name: str, values: Sequence[float] | np.ndarray) -> str:
    numbers = [literal(value) for value in np.ravel(np.asarray(values, dtype=float))]
    lines = [", ".join(numbers[k : k + 5]) for k in range(0, len(numbers), 5)]
    body = ",\n    ".join(lines)
    return f"static const double {name}[{len(numbers)}] = {{\n    {body},\n}};"


def box_text(keys: Mapping[str, Any], inputs: Sequence[str], is_scaled: bool = False) -> str:
    """Ranges of the inputs, and scaled_inputs or clamped_inputs."""
    name = "scaled" if is_scaled else "clamped"
    return f"""{ranges_text(keys, inputs)}
static void {name}_inputs(const motion *m, double *u) {{
    const double said[INPUTS] = {{{said_text(inputs)}}};
    for (int k = 0; k < INPUTS; ++k) {{
        u[k] = quiesce_{name}(said[k], low[k], high[k]);
    }}
}}
"""


def ranges_text(keys: Mapping[str, Any], inputs: Sequence[str]) -> str:
    return f"""enum {{ INPUTS = {len(inputs)} }};
static const double low[INPUTS] = {{{literals(keys[key]["range"][0] for key in inputs)}}};
static const double high[INPUTS] = {{{literals(keys[key]["range"][1] for key in inputs)}}};
"""


def said_text(inputs: Sequence[str]) -> str:
    return ", ".join(SEEN[key] for key in inputs)


def layers_text(name: str, layers: Sequence[Mapping[str, Any]], inputs: int) -> Layers:
    units = [int(layer["units"]) for layer in layers]
    tables = "\n".join(
        array(f"{name}_{k}_{key}", layer[key])
        for k, layer in enumerate(layers)
        for key in ("weights", "biases")
    )
    rows = ",\n    ".join(
        f"{{{before}, {count}, {name}_{k}_weights, {name}_{k}_biases}}"
        for k, (before, count) in enumerate(zip([inputs, *units], units, strict=False))
    )
    text = (
        f"{tables}\nstatic const struct quiesce_layer {name}[{len(units)}] = {{\n    {rows},\n}};\n"
    )
    return Layers(text, len(units), max([1, *units[:-1]]))
