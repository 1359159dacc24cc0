"""Earthquakes at three speeds and random forces: each setting by its own aim, against the constant
current that is best for that aim and input. Nobody can know that current beforehand."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.errors import UsageError
from quiesce.base.paths import measurements
from quiesce.base.table import format_table

from quiesce_benchmarks.control.broadband import record_length_s, sized
from quiesce_benchmarks.control.rig import (
    BALANCED,
    DISPLACEMENT,
    OPEN_LOOP,
    SETTINGS,
    Rig,
    constant,
    grid_A,
)
from quiesce_benchmarks.control.scenarios import Scenario, earthquake, random_force
from quiesce_benchmarks.lock.rig import phase_rig
from quiesce_benchmarks.part import Effort, Measured

TITLE = "broadband: earthquakes at three speeds, random forces"
FIGURES = (
    ("broadband_disp_ratio", "1", 1.02, "lower"),
    ("broadband_peak_ratio", "1", 1.05, "lower"),
    ("broadband_accel_ratio", "1", 1.05, "lower"),
    ("broadband_valid_pct", "%", None, "lower"),
    ("broadband_others_accel_ratio", "1", None, "lower"),
    ("broadband_others_harm", "1", None, "lower"),
    ("narrow_to_full_s", "s", None, "lower"),
)

SPEEDS = (1.0, 2.0, 5.0)
AFTER_s = 2.0  # of free decay
PEAK_um = 100.0  # without current: well above what counts as rest
BANDS_Hz = ((3.0, 7.0), (5.0, 6.0), (7.0, 15.0), (4.0, 22.0), (3.0, 22.0), (2.0, 40.0))
RANDOM_s = 60.0
# Others, which nothing was chosen by, at parts of the plant's drive.
OTHERS_Hz = ((2.0, 4.0), (2.0, 5.0), (3.5, 5.0), (4.5, 8.0), (3.0, 9.0), (4.0, 10.0), (6.0, 7.5))
OTHERS_PARTS = (1.0, 0.4)
# From a band below resonance on to one with it: how long the smaller current stays.
BELOW_Hz, WITH_IT_Hz = (3.0, 7.0), ((7.0, 15.0), (9.0, 13.0), (4.0, 22.0))
MOVES_AFTER_s = 30.0
GRID_STEP_A = 0.25
QUICK_STEP_A = 1.25
FRONT_A = (0.25, 1.0, 2.5, 5.0)  # columns of the front
MEAN_Hz = (2.0, 52.0)  # in which mean frequencies are taken


@dataclass(frozen=True)
class Found:
    """One input: figures of the bench, with constant currents by A and with the law by setting."""

    name: str
    constants: dict[float, dict[str, Any]]
    law: dict[str, dict[str, Any]]
    valid_pct: dict[str, float]  # share of the time that a component is trusted
    mean_Hz: tuple[float, float]  # with the full current: mean_frequencies_Hz

    def best_A(self, key: str) -> float:
        return min(self.constants, key=lambda current_A: float(self.constants[current_A][key]))

    def ratio(self, setting: str, key: str) -> float:
        return float(self.law[setting][key] / self.constants[self.best_A(key)][key])

    @property
    def disp_ratio(self) -> float:
        return self.ratio(DISPLACEMENT, "rms_disp_um")

    @property
    def peak_ratio(self) -> float:
        return self.ratio(DISPLACEMENT, "peak_disp_um")

    @property
    def accel_ratio(self) -> float:
        return self.ratio(BALANCED, "accel_rms_mm_s2")

    @property
    def harm(self) -> float:
        """Of setting balanced's acceleration, against all the current throughout."""
        key = "accel_rms_mm_s2"
        return float(self.law[BALANCED][key] / self.constants[max(self.constants)][key])

    def front(self) -> list[str]:
        """Best currents, and what others do against them."""
        disp, accel = "rms_disp_um", "accel_rms_mm_s2"
        best = {key: self.constants[self.best_A(key)][key] for key in (disp, accel)}
        shares = [
            f"{self.constants[nearest(self.constants, current_A)][key] / best[key]:.3f}"
            for key in (disp, accel)
            for current_A in FRONT_A
        ]
        means = [f"{one:.1f}" for one in self.mean_Hz]
        return [self.name, f"{self.best_A(disp):.2f}", f"{self.best_A(accel):.2f}", *shares, *means]

    def row(self) -> list[str]:
        ratios = [f"{one:.3f}" for one in (self.disp_ratio, self.peak_ratio, self.accel_ratio)]
        return [self.name, *ratios, *(f"{self.valid_pct[name]:.0f}" for name in SETTINGS)]


def nearest(constants: dict[float, dict[str, Any]], current_A: float) -> float:
    return min(constants, key=lambda known_A: abs(known_A - current_A))


def quakes(rig: Rig, folder: Path) -> list[Callable[[], Scenario]]:
    """Every record of the folder at every speed, scaled to PEAK_um when it is made."""

    def made(file: Path, speed: float) -> Scenario:
        duration_s = round(record_length_s(file) / speed + AFTER_s, 3)
        one = sized(rig, earthquake(file.stem, file, 1e-2, speed, duration_s), "gain", PEAK_um)
        return replace(one, name=f"{file.stem} x{speed:g}")

    files = sorted(folder.glob("*.csv"))
    if not files:
        raise UsageError("no recorded earthquakes on this machine (data/earthquake/*.csv)")
    return [partial(made, file, speed) for file in files for speed in SPEEDS]


def randoms(rig: Rig, seed: int) -> list[Callable[[], Scenario]]:
    drive_V = float(rig.plant.drive_V / np.sqrt(2.0))
    return [partial(random_force, *band, drive_V, seed, RANDOM_s) for band in BANDS_Hz]


def others(rig: Rig, seed: int) -> list[Callable[[], Scenario]]:
    drive_V = float(rig.plant.drive_V / np.sqrt(2.0))

    def made(band_Hz: tuple[float, float], part: float) -> Scenario:
        one = random_force(*band_Hz, part * drive_V, seed, RANDOM_s)
        return replace(one, name=f"{one.name}, {part:g} of the drive")

    return [partial(made, band, part) for band in OTHERS_Hz for part in OTHERS_PARTS]


def full_after_s(rig: Rig, seed: int, band_Hz: tuple[float, float]) -> float:
    """From the change of bands until the command is all the current again."""
    drive_V = float(rig.plant.drive_V / np.sqrt(2.0))
    below = random_force(*BELOW_Hz, drive_V, seed, MOVES_AFTER_s)
    then = random_force(*band_Hz, drive_V, seed + 1, MOVES_AFTER_s)
    scenario = replace(
        below,
        name=f"{below.name}, then {then.name}",
        duration_s=2.0 * MOVES_AFTER_s,
        segments=(*below.segments, *then.segments),
    )
    columns = ("t_s", "current_cmd_mA")
    trace = rig.run(scenario, rig.judged.control(BALANCED), columns=columns).trace
    assert trace is not None
    is_full = trace["current_cmd_mA"] >= 999.0 * rig.full_A
    after = trace["t_s"][(trace["t_s"] >= MOVES_AFTER_s) & is_full]
    return float(after[0] - MOVES_AFTER_s) if len(after) else MOVES_AFTER_s


def measure_input(rig: Rig, make: Callable[[], Scenario], step_A: float) -> Found:
    scenario = make()
    constants = {0.0: rig.run(scenario, OPEN_LOOP).figures}
    for current_A in grid_A(rig.full_A, step_A)[1:]:
        constants[current_A] = rig.run(scenario, constant(current_A)).figures
    full = rig.run(scenario, constant(rig.full_A), columns=("t_s", "a5_mm_s2")).trace
    assert full is not None
    law, valid_pct = {}, {}
    for setting in SETTINGS:
        done = rig.run(scenario, rig.judged.control(setting), columns=("freq_is_valid",))
        assert done.trace is not None
        law[setting] = done.figures
        valid_pct[setting] = 100.0 * float((done.trace["freq_is_valid"] > 0).mean())
    means_Hz = mean_frequencies_Hz(full["t_s"], full["a5_mm_s2"])
    return Found(scenario.name, constants, law, valid_pct, means_Hz)


def mean_frequencies_Hz(t_s: np.ndarray, accel: np.ndarray) -> tuple[float, float]:
    """RMS of the acceleration over that of the velocity, and of the velocity over that of the
    displacement, of what lies in MEAN_Hz; both over 2 pi. Even steps."""
    freq_Hz = np.fft.rfftfreq(len(accel), float(np.median(np.diff(t_s))))
    inside = (freq_Hz >= MEAN_Hz[0]) & (freq_Hz <= MEAN_Hz[1])
    power = np.abs(np.fft.rfft(accel - accel.mean()))[inside] ** 2
    of_accel, of_velocity, of_displacement = (
        float((power / freq_Hz[inside] ** order).sum()) for order in (0, 2, 4)
    )
    return (of_accel / of_velocity) ** 0.5, (of_velocity / of_displacement) ** 0.5


def tables_of(found: Sequence[Found]) -> tuple[str, ...]:
    heads = [f"{what}\n{current_A:g} A" for what in ("x", "a") for current_A in FRONT_A]
    front = format_table(
        ["against the best constant", "best for x\nA", "for a\nA", *heads, "a/v\nHz", "v/x\nHz"],
        [one.front() for one in found],
    )
    law = format_table(
        ["the phase law", "x RMS", "x peak", "a RMS", "valid\ndisp. %", "balanced\n%"],
        [one.row() for one in found],
    )
    return (front, law)


def measure(effort: Effort) -> Measured:
    step_A = QUICK_STEP_A if effort.is_quick else GRID_STEP_A
    with phase_rig(effort) as rig:
        makes = [*randoms(rig, effort.seed), *quakes(rig, measurements("earthquake"))]
        judged = len(makes)
        makes += others(rig, effort.seed + 1)
        measured: list[Found] = rig.work(
            [
                (f"input {i + 1}", partial(measure_input, rig, make, step_A))
                for i, make in enumerate(makes)
            ]
        )
        moves_s = [full_after_s(rig, effort.seed + 1, band) for band in WITH_IT_Hz]
    found, beside = measured[:judged], measured[judged:]
    return Measured(
        {
            "broadband_disp_ratio": max(one.disp_ratio for one in found),
            "broadband_peak_ratio": max(one.peak_ratio for one in found),
            "broadband_accel_ratio": max(one.accel_ratio for one in found),
            "broadband_valid_pct": max(max(one.valid_pct.values()) for one in found),
            "broadband_others_accel_ratio": max(one.accel_ratio for one in beside),
            "broadband_others_harm": max(one.harm for one in beside),
            "narrow_to_full_s": max(moves_s),
        },
        {
            "inputs": [one.row() for one in found],
            "front": [one.front() for one in found],
            "others": [[one.name, one.accel_ratio, one.harm] for one in beside],
        },
        (*tables_of(found), *tables_of(beside)),
    )
