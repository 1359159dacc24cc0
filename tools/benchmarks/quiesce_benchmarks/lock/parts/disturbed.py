"""A steady component with something beside it: a second tone, lost ticks, lost samples. The lock
must hold, and the pulses must do what they do undisturbed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from quiesce.base.table import format_table

from quiesce_benchmarks.control.measures import reduction_pct
from quiesce_benchmarks.control.rig import DISPLACEMENT, OPEN_LOOP, Rig
from quiesce_benchmarks.control.scenarios import Scenario, frozen, whole
from quiesce_benchmarks.lock.rig import phase_rig
from quiesce_benchmarks.part import Effort, Measured

TITLE = "disturbed: a second tone, lost ticks and samples"
FIGURES = (
    ("second_tone_lock_pct", "%", 99.0, "higher"),
    ("second_tone_share", "1", 0.9, "higher"),
    ("lost_tick_lock_pct", "%", 99.0, "higher"),
    ("lost_tick_share", "1", 0.9, "higher"),
)

FREQS_Hz = (5.0, 10.0, 15.0, 20.0)
QUICK_FREQS_Hz = (5.0, 15.0)
SECONDS_Hz = (2.6, 3.7, 6.3, 8.1, 11.7, 13.3, 16.9, 23.3, 31.0)
APART = 0.15  # of the component's frequency: the second tone is another one, no beat
HARMONIC = 0.03  # a third harmonic is the component's own
SIZE = 0.3  # of acceleration or displacement without current, whichever is more
LOST_EVERY_s = 0.097  # in no step with the vibration
DURATION_s, FROM_s, LAST_s = 20.0, 2.0, 8.0
NEAR_Hz = 0.3
TRACE = ("x5_um", "a5_mm_s2")
TIMED = ("t_s", *TRACE)
LOCKED = (*TIMED, "freq_uHz", "lock_is_on")


@dataclass(frozen=True)
class Case:
    name: str
    freq_Hz: float
    scenario: Scenario


@dataclass(frozen=True)
class Found:
    case: Case
    reduction_pct: float  # of the component's displacement
    lock_pct: float  # of the time from FROM_s on, and at the component

    def row(self, alone: "Found") -> list[str]:
        share = self.reduction_pct / alone.reduction_pct
        one = self.case
        return [
            f"{one.freq_Hz:g}", one.name, f"{alone.reduction_pct:.1f}", f"{self.reduction_pct:.1f}",
            f"{share:.3f}", f"{self.lock_pct:.1f}",
        ]  # fmt: skip


def tones(rig: Rig, freq_Hz: float, second_Hz: float = 0.0, part: float = 0.0) -> Scenario:
    """Both with the plant's drive, the second with a part of it."""
    drive_V = rig.plant.drive_V
    two = [frozen(freq_Hz=freq_Hz, drive_V=drive_V)]
    if part > 0.0:
        two.append(frozen(freq_Hz=second_Hz, drive_V=part * drive_V, phase_deg=37.0))
    return whole(f"{freq_Hz:g} Hz", DURATION_s, frozen(kind="tones", tone=tuple(two)))


def amplitude(time_s: np.ndarray, values: np.ndarray, freq_Hz: float) -> float:
    """Of one component, over the last LAST_s under a Hann window."""
    last = time_s >= time_s[-1] - LAST_s
    window = np.hanning(int(last.sum()))
    rest = values[last] - values[last].mean()
    turned = rest * window * np.exp(-2j * np.pi * freq_Hz * time_s[last])
    return float(2.0 * abs(turned.sum()) / window.sum())


def size(rig: Rig, scenario: Scenario, freq_Hz: float) -> np.ndarray:
    """Displacement and acceleration of a component without current."""
    trace = rig.run(scenario, OPEN_LOOP, columns=TIMED).trace
    assert trace is not None
    return np.array([amplitude(trace["t_s"], trace[name], freq_Hz) for name in TRACE])


def with_second(rig: Rig, freq_Hz: float, second_Hz: float) -> Case:
    """Nothing here is linear, but for the part of the drive this is near enough."""
    ratios = size(rig, tones(rig, second_Hz), second_Hz) / size(rig, tones(rig, freq_Hz), freq_Hz)
    part = float(SIZE / ratios.max())
    return Case(f"and {second_Hz:g} Hz", freq_Hz, tones(rig, freq_Hz, second_Hz, part))


def with_faults(rig: Rig, freq_Hz: float, kind: str) -> Case:
    count = int(DURATION_s / LOST_EVERY_s)
    faults = tuple((kind, round(LOST_EVERY_s * (i + 0.5), 3), 0.001) for i in range(count))
    return Case(f"{kind}, 1 in 97", freq_Hz, replace(tones(rig, freq_Hz), faults=faults))


def measure_case(rig: Rig, case: Case) -> Found:
    control = rig.judged.control(DISPLACEMENT, "off")
    trace = rig.run(case.scenario, control, columns=LOCKED).trace
    assert trace is not None
    without = size(rig, case.scenario, case.freq_Hz)[0]
    reached = amplitude(trace["t_s"], trace["x5_um"], case.freq_Hz)
    late = trace["t_s"] >= FROM_s
    is_there = np.abs(1e-6 * trace["freq_uHz"][late] - case.freq_Hz) <= NEAR_Hz
    is_locked = (trace["lock_is_on"][late] > 0) & is_there
    return Found(case, reduction_pct(reached, without), 100.0 * float(is_locked.mean()))


def is_another(freq_Hz: float, second_Hz: float) -> bool:
    times = second_Hz / freq_Hz
    return abs(times - 1.0) > APART and abs(times / 3.0 - 1.0) > HARMONIC


def measure_freq(rig: Rig, freq_Hz: float) -> tuple[Found, list[Found], list[Found]]:
    """Undisturbed, with second tones, with lost ticks and samples."""
    alone = measure_case(rig, Case("alone", freq_Hz, tones(rig, freq_Hz)))
    seconds = [
        measure_case(rig, with_second(rig, freq_Hz, second_Hz))
        for second_Hz in SECONDS_Hz
        if is_another(freq_Hz, second_Hz)
    ]
    lost = [measure_case(rig, with_faults(rig, freq_Hz, kind)) for kind in ("lost_tick", "dropout")]
    return alone, seconds, lost


def worst(found: Sequence[tuple[Found, list[Found]]]) -> tuple[float, float]:
    """Least time locked in %, least share of what is reached undisturbed."""
    pairs = [(alone, one) for alone, many in found for one in many]
    return (
        min(one.lock_pct for _, one in pairs),
        min(one.reduction_pct / alone.reduction_pct for alone, one in pairs),
    )


def measure(effort: Effort) -> Measured:
    freqs_Hz = QUICK_FREQS_Hz if effort.is_quick else FREQS_Hz
    with phase_rig(effort) as rig:
        found: list[Any] = rig.work(
            [(f"{freq_Hz:g} Hz", partial(measure_freq, rig, freq_Hz)) for freq_Hz in freqs_Hz]
        )
    second = worst([(alone, seconds) for alone, seconds, _ in found])
    lost = worst([(alone, faults) for alone, _, faults in found])
    rows = [
        one.row(alone) for alone, seconds, faults in found for one in (alone, *seconds, *faults)
    ]
    heads = ["Hz", "beside it", "alone\n%", "taken off\n%", "share", "locked\n%"]
    return Measured(
        {
            "second_tone_lock_pct": second[0],
            "second_tone_share": second[1],
            "lost_tick_lock_pct": lost[0],
            "lost_tick_share": lost[1],
        },
        {"cases": rows},
        (format_table(heads, rows),),
    )
