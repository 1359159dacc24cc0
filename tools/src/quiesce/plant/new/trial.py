"""A short run of what was written: that it runs, how far it moves, how hard it shakes."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.params import parameters
from quiesce.engine.trace import read_trace
from quiesce.plant.new.text import ONLY, STEPS

TRACED = "a5_mm_s2"  # true acceleration at the tracked sensor


@dataclass(frozen=True)
class Step:
    """Steady state at one frequency, at the tracked sensor."""

    freq_Hz: float
    disp_um: float  # amplitude, relative to the base
    accel_mm_s2: float  # RMS


@dataclass(frozen=True)
class Trial:
    steps: list[Step]
    peak_m_s2: float
    stroke_um: float  # largest of the damper in a step


def run_trial(bench: Bench, folder: Path, current_mA: int) -> Trial:
    """The steps at a constant current. UsageError in the bench's words where they do not run."""
    usual_mA = next(one["default"] for one in parameters() if one["name"] == "max_current_mA")
    settings = [f"max_current_mA={max(current_mA, usual_mA)}", f"constant_current_mA={current_mA}"]
    law = ["--law", "constant", *setting_options(settings)] if current_mA else ["--law", "off"]
    with tempfile.TemporaryDirectory(prefix="quiesce-") as scratch:
        file = Path(scratch) / "trace"
        figures = bench.json(
            "run", "--scenario", str(folder / STEPS), *law,
            "--trace", str(file), "--columns", TRACED,
        )  # fmt: skip
        peak = float(np.abs(read_trace(file)[TRACED]).max())
    strokes = [window["dampers"][ONLY]["peak_stroke_um"] for window in figures["rig"]]
    return Trial([_step(window) for window in figures["windows"]], 1e-3 * peak, max(strokes))


def _step(window: dict[str, Any]) -> Step:
    return Step(window["freq_hz"], window["amp_um"], window["accel_rms_mm_s2"])
