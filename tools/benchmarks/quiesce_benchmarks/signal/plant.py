"""The frozen plant's acceleration as the sensor sees it: stick-slip, and steps of its drive."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.paths import default_plant
from quiesce.engine.bench import setting_options
from quiesce.engine.trace import Trace, read_trace

from quiesce_benchmarks.signal.offline import trailing_Hz
from quiesce_benchmarks.signal.records import Rig, Tally
from quiesce_benchmarks.signal.response import SETTLED_SHARE, ticks_until_lasting

NOISE_mg = 0.5
STICK_Hz = (4.0, 5.0, 6.0)
STICK_CURRENT_mA = 5000
STICK_s, STEADY_FROM_s = 8.0, 4.0
TOLERANCE = 0.02
STEP_CURRENTS_mA = (0, 5000)
STEP_SEGMENT_s = 4.0
OFFLINE_EVERY_s = 0.005
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
        f'plant = "{default_plant()}"\nduration_s = {duration_s}\nnoise_mg = {NOISE_mg}\n\n'
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


def measure_plant_step(
    rig: Rig, seed: int, from_Hz: float, to_Hz: float, current_mA: int
) -> dict[str, Any]:
    """Step of the drive's frequency: the chain beside least squares over windows of equal length.

    The offline estimate is of one tone, at every OFFLINE_EVERY_s, over as many samples as the chain
    reports. Free decay of the structure is part of what both see.
    """
    rate_Hz = rig.rate_Hz
    trace = run_plant(rig, [from_Hz, to_Hz], STEP_SEGMENT_s, current_mA, seed)
    start = rig.ticks(STEP_SEGMENT_s)
    told_Hz = trace["freq_uHz"] * 1e-6
    is_valid = trace["freq_is_valid"] > 0
    ends = np.arange(start, len(told_Hz), rig.ticks(OFFLINE_EVERY_s))
    lengths = np.rint(trace["freq_window_ms"][ends] * 1e-3 * rate_Hz).astype(int)
    offline_Hz = trailing_Hz(trace["accel_counts"], ends, lengths, rate_Hz, tones=1)
    compared = is_valid[ends] & np.isfinite(offline_Hz)
    apart_Hz = (told_Hz[ends] - offline_Hz)[compared]
    return {
        "step": f"{from_Hz:g} -> {to_Hz:g} Hz",
        "current_A": current_mA * 1e-3,
        "settle_s": lasting_s(told_Hz[start:], to_Hz, 1.0 / rate_Hz),
        "offline_settle_s": lasting_s(offline_Hz, to_Hz, OFFLINE_EVERY_s),
        "invalid_after_ms": first_ms(~is_valid[start:], rate_Hz),
        "valid_pct": 100.0 * float(is_valid[start:].mean()),
        "rms_apart_Hz": float(np.sqrt(np.mean(np.square(apart_Hz)))) if compared.any() else None,
    }


def lasting_s(freq_Hz: np.ndarray, target_Hz: float, period_s: float) -> float | None:
    """Time from which the frequency stays within 5 %; None where it ends elsewhere."""
    is_near = np.abs(freq_Hz / target_Hz - 1.0) <= SETTLED_SHARE
    if not is_near[-1]:
        return None
    return float(ticks_until_lasting(is_near[None, :], np.zeros(1, dtype=int))[0]) * period_s


def first_ms(is_it: np.ndarray, rate_Hz: int) -> float | None:
    return 1e3 * float(np.argmax(is_it)) / rate_Hz if is_it.any() else None
