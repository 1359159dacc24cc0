"""The actions of `quiesce identify` as the tests run them, and damper models to run them on."""

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from quiesce.base.command import Parser
from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record
from quiesce.damper.library import Model, Scales
from quiesce.damper.model_file import DamperModel

SCALES = Scales(1000.0, 8e-3, 0.1)


def act(action: ModuleType, *arguments: str | Path) -> int:
    """`quiesce identify NAME ARGUMENTS`; its exit code."""
    parser = Parser(prog=f"quiesce identify {action.NAME}")
    action.add_options(parser)
    args = parser.parse_args([str(one) for one in arguments])
    return action.run(args)


def refused(action: ModuleType, *arguments: str | Path) -> str:
    """The one line with which an action refuses its input."""
    with pytest.raises(UsageError) as caught:
        act(action, *arguments)
    text = str(caught.value)
    assert text and "\n" not in text
    return text


def write(file: Path, damper: DamperModel) -> Path:
    file.write_text(damper.to_toml(), encoding="utf-8")
    return file


def kwok_rd1005(**changes: Any) -> DamperModel:
    """The RD-1005-3 as Kwok's tanh model; its force rises with the current up to 1.88 A."""
    parameters: dict[str, Any] = {
        "c_N_s_m": [1232.0, 1929.0],
        "k_N_m": [5100.0, -1700.0],
        "alpha_N": [32.0, 918.0, -244.0],
        "beta_s_m": 100.0,
        "delta": [0.58, 0.3],
        "f0_N": [57.0, -18.0],
        "x_s_m": 1e-4,
    }
    return DamperModel("RD-1005-3", "kwok_tanh", 0.025, 0.3, parameters | changes)


def dissipative_tanh(**changes: Any) -> DamperModel:
    """A static model whose force is quadratic in the current and opposes the motion."""
    parameters: dict[str, Any] = {
        "c_N_s_m": [600.0, 700.0],
        "k_N_m": 0.0,
        "alpha_N": [40.0, 900.0, -150.0],
        "beta_s_m": 60.0,
        "delta": 0.0,
        "f0_N": 0.0,
        "x_s_m": 0.0,
    }
    return DamperModel("static", "kwok_tanh", 0.025, 0.3, parameters | changes)


def two_tones(
    rate_Hz: float = 500.0, duration_s: float = 2.0, current_A: float | Sequence[float] = 0.5
) -> Record:
    """8 mm and 1 mm at two frequencies, with exact derivatives, no force."""
    time_s = np.arange(round(duration_s * rate_Hz)) / rate_Hz
    disp, velocity, accel = (np.zeros(len(time_s)) for _ in range(3))
    for size_m, freq_Hz in ((8e-3, 1.3), (1e-3, 6.7)):
        w = 2.0 * np.pi * freq_Hz
        disp += size_m * np.sin(w * time_s)
        velocity += size_m * w * np.cos(w * time_s)
        accel -= size_m * w**2 * np.sin(w * time_s)
    command = np.broadcast_to(np.asarray(current_A, float), time_s.shape).copy()
    zero = np.zeros(len(time_s))
    return Record("two tones", rate_Hz, time_s, disp, velocity, accel, zero, command, "A")


def middle_of(one: Model) -> DamperModel:
    """A model with every parameter well inside its search range, and none of them 0."""
    values = {}
    for parameter in one.parameters:
        low, high = parameter.search_range(SCALES)
        is_wide = low > 0.0 and high / low > 8.0
        middle = float(np.sqrt(low * high) if is_wide else 0.3 * low + 0.7 * high)
        values[parameter.name] = min(max(middle, parameter.min), parameter.max)
    return DamperModel(one.name, one.name, 0.05, 0.2, values)
