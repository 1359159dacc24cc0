"""The frozen plant's acceleration as the sensor sees it: stick-slip, and steps of its drive."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.bench_exe import setting_options
from quiesce.paths import root
from quiesce.signal_records import Rig, Tally
from quiesce.trace import Trace, read_trace

PLANT = "sim_hil/plants/squeeze_2012.toml"
NOISE_mg = 0.5
STICK_Hz = (4.0, 5.0, 6.0)
STICK_CURRENT_mA = 5000
STICK_s, STEADY_FROM_s = 8.0, 4.0
TOLERANCE = 0.02
COLUMNS = ["t_s", "accel_counts", "freq_is_valid", "freq_uHz", "freq_window_ms"]


@dataclass(frozen=True)
class StickSlip:
    freq_Hz: float
    valid_share: float  # of the steady ticks
    right_share: float  # valid and within 2 % of the fundamental
    held_right_share: float  # within 2 %, valid or not
    tally: Tally

    def row(self) -> dict[str, Any]:
        return {
            "freq_Hz": self.freq_Hz,
            "valid_pct": 100.0 * self.valid_share,
            "fundamental_pct": 100.0 * self.right_share,
            "fundamental_or_held_pct": 100.0 * self.held_right_share,
            "valid_but_wrong_pct": self.tally.wrong_pct,
        }


def scenario_text(freqs_Hz: Sequence[float], segment_s: float) -> str:
    """A scenario of sines one after the other, phase-continuous, on the frozen plant."""
    duration_s = segment_s * len(freqs_Hz)
    segments = "".join(
        f'[[segment]]\nkind = "sine"\nfreq_Hz = {freq_Hz}\nduration_s = {segment_s}\n\n'
        for freq_Hz in freqs_Hz
    )
    return (
        'schema = "quiesce-scenario"\nversion = 1\nname = "bench"\n'
        f'plant = "{root() / PLANT}"\nduration_s = {duration_s}\nnoise_mg = {NOISE_mg}\n\n'
        f"{segments}[[window]]\nstart_s = {duration_s / 2.0}\nend_s = {duration_s}\n"
    )


def run_plant(
    rig: Rig, freqs_Hz: Sequence[float], segment_s: float, current_mA: int, seed: int
) -> Trace:
    """Every tick of COLUMNS, under a constant current."""
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        scenario, trace_file = Path(folder) / "scenario.toml", Path(folder) / "trace"
        scenario.write_text(scenario_text(freqs_Hz, segment_s), encoding="utf-8")
        rig.bench.call(
            "run", "--scenario", str(scenario), "--law", "constant", "--seed", str(seed),
            "--trace", str(trace_file),
            *setting_options([*rig.settings, f"constant_current_mA={current_mA}"]),
        )  # fmt: skip
        return read_trace(trace_file, COLUMNS)


def measure_stick_slip(rig: Rig, seed: int, runs: int, freq_Hz: float) -> StickSlip:
    traces = [
        run_plant(rig, [freq_Hz], STICK_s, STICK_CURRENT_mA, seed + number)
        for number in range(runs)
    ]
    tally = Tally()
    for trace in traces:
        tally.add(trace["freq_uHz"], trace["freq_is_valid"], np.array(freq_Hz))
    is_steady = traces[0]["t_s"] >= STEADY_FROM_s
    told_Hz = np.concatenate([trace["freq_uHz"][is_steady] for trace in traces]) * 1e-6
    is_valid = np.concatenate([trace["freq_is_valid"][is_steady] for trace in traces]) > 0
    is_right = np.abs(told_Hz / freq_Hz - 1.0) <= TOLERANCE
    return StickSlip(
        freq_Hz=freq_Hz,
        valid_share=float(is_valid.mean()),
        right_share=float((is_valid & is_right).mean()),
        held_right_share=float(is_right.mean()),
        tally=tally,
    )
