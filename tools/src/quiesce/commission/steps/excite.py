"""What the structure answers: a first look where its first mode is not known, then a sweep at 0 A
and dwells around that mode with steps of the current."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from quiesce.commission.work import RECORDING, Work
from quiesce.plant_id.modes import SweepModel, find_modes
from quiesce.plant_id.plant_file import read_base
from quiesce.plant_id.recording import read_sweep_recording
from quiesce.plant_id.sweep import (
    MIN_SAMPLES_A_PERIOD,
    SweepPlan,
    Timeline,
    duration_s,
    timeline,
)

NAME = "excite"
TITLE = "excite"
LOOK = "first_look"
# In parts of the first mode's frequency: where a damper shows most (docs/howto/
# find-a-plant-from-a-sweep.md), and the band that a table's frequencies are in.
TELLING_PARTS = (0.45, 0.75, 1.05, 1.6)
FROM_PART, TO_PART = 0.3, 10.0
LEAST_RATE_Hz = 200
RATES_Hz = (200, 250, 500, 1000, 2000, 4000)
REST_DECAYS, HOLD_DECAYS = 5.0, 2.5
RESTS_S, HOLDS_S = (2.0, 20.0), (1.0, 5.0)
LOOK_S, SWEEP_S, QUICK_SWEEP_S = 40.0, 60.0, 40.0
STRONG_PART = 0.25  # of the strongest answer: the lowest mode that is as strong is the first
UNKNOWN_DAMPING = 0.02


def run(work: Work) -> dict[str, Any]:
    first_Hz, damping = work.wants.first_mode_Hz, UNKNOWN_DAMPING
    if first_Hz is None:
        first_Hz, damping = looked_at(work)
        work.tell(f"a first mode at {first_Hz:.3g} Hz, damping {damping:.3g}")
    plan = plan_of(work, first_Hz, damping)
    line = timeline(plan)
    if work.wants.damper is not None:
        line = replace(line, current_A=np.zeros_like(line.current_A))
    work.tell(f"{duration_s(plan):.0f} s at {plan.rate_Hz} Hz")
    has_damper = work.wants.damper is None
    work.site.played(line, RECORDING, has_damper)
    if not has_damper:
        work.site.mount_damper()
    return {
        "has_damper": has_damper,
        "first_Hz": first_Hz,
        "rate_Hz": plan.rate_Hz,
        "drive_V": plan.drive_V,
        "max_current_A": float(line.current_A.max()),
        "length_s": duration_s(plan),
    }


def looked_at(work: Work) -> tuple[float, float]:
    """The first mode's frequency and damping, from a sweep alone, at 0 A."""
    low_Hz, high_Hz = work.wants.band_Hz
    plan = SweepPlan(
        rate_Hz=rate_Hz(high_Hz),
        low_Hz=low_Hz,
        high_Hz=high_Hz,
        sweep_s=LOOK_S,
        drive_V=work.drive_V,
        dwell_Hz=(low_Hz,),
        dwell_drive_V=work.drive_V,
        rest_s=RESTS_S[1] / 4.0,
    )
    whole = timeline(plan)
    count = round((LOOK_S + 2.0 * plan.rest_s) * plan.rate_Hz)
    line = Timeline(
        plan.rate_Hz, whole.amplitude_V[:count], whole.phase_cycles[:count], np.zeros(count)
    )
    work.site.played(line, LOOK, work.wants.damper is None)
    recording = read_sweep_recording(work.path / f"{LOOK}.csv")
    base = read_base(work.base_plant, work.wants.modal_mass_kg, 0.0, True)
    modes = find_modes(SweepModel(recording, base.ref_freq_Hz), work.wants.mode_count)
    # At its own frequency, against the drive.
    answers = np.abs(modes.residue_m_s2_V) / modes.damping_ratio
    first = int(np.argmax(answers >= STRONG_PART * answers.max()))
    return float(modes.freq_Hz[first]), float(modes.damping_ratio[first])


def plan_of(work: Work, first_Hz: float, damping: float) -> SweepPlan:
    """Around the first mode, with rests in which it dies away."""
    low_Hz, high_Hz = work.wants.band_Hz
    low_Hz = max(low_Hz, float(f"{FROM_PART * first_Hz:.3g}"))
    high_Hz = min(high_Hz, float(f"{TO_PART * first_Hz:.3g}"))
    decay_s = 1.0 / (2.0 * math.pi * first_Hz * max(damping, 1e-3))
    return SweepPlan(
        rate_Hz=rate_Hz(high_Hz),
        low_Hz=low_Hz,
        high_Hz=high_Hz,
        sweep_s=QUICK_SWEEP_S if work.wants.is_quick else SWEEP_S,
        drive_V=work.drive_V,
        dwell_Hz=tuple(float(f"{part * first_Hz:.3g}") for part in TELLING_PARTS),
        dwell_drive_V=work.drive_V,
        max_current_A=1e-3 * work.site.limit_mA,
        hold_s=within(HOLDS_S, HOLD_DECAYS * decay_s),
        rest_s=within(RESTS_S, REST_DECAYS * decay_s),
    )


def rate_Hz(high_Hz: float) -> int:
    """The lowest that shows this frequency; what is sampled faster takes longer to fit."""
    needed = max(LEAST_RATE_Hz, MIN_SAMPLES_A_PERIOD * high_Hz)
    return next((one for one in RATES_Hz if one >= needed), math.ceil(needed))


def within(ends: tuple[float, float], value: float) -> float:
    return float(f"{min(max(value, ends[0]), ends[1]):.3g}")


def line(result: dict[str, Any]) -> str:
    return (
        f"first mode about {result['first_Hz']:.3g} Hz; {result['length_s']:.0f} s recorded at "
        f"{result['rate_Hz']} Hz, up to {result['max_current_A']:g} A"
    )
