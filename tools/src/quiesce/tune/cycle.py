"""One cycle of the closed loop's steady state, to explain what the pulses do."""

import math
from dataclasses import dataclass

import numpy as np

from quiesce.engine.trace import Trace
from quiesce.optimum.periodic import Floats
from quiesce.plant.library import Plant
from quiesce.tune.law import SETTLED_DECAYS, slowest_decay_s
from quiesce.tune.phase_table import PhaseLaw
from quiesce.tune.plan import TunePlan
from quiesce.tune.robust import ClosedLoop

# Below and above the first mode, in parts of its frequency.
BELOW_PART, ABOVE_PART = 0.45, 1.35
# Lock, blend and a margin.
LOCKED_s, SETTLINGS = 5.0, 4.0
FITTED_CYCLES, HARMONICS = 4, (1, 3)


@dataclass(frozen=True)
class Cycle:
    """Over one cycle from the displacement's peak; the setting with more pulse is shown."""

    freq_Hz: float
    setting: str
    turn_deg: Floats  # phase of the displacement's fundamental
    disp_um: Floats
    coil_A: Floats
    force_mN: Floats  # that resists the motion
    uncontrolled_um: float  # half peak-to-peak
    stiffness_N_m: float  # of the force's fundamental: below 0 it works like a mass
    damping_N_s_m: float


def cycles(plan: TunePlan, plant: Plant, law: PhaseLaw, loop: ClosedLoop) -> list[Cycle]:
    """Below and above the first mode, where the table reaches."""
    first_Hz = plant.modes[0].freq_Hz
    near = [nearest(plan.freqs_Hz, part * first_Hz) for part in (BELOW_PART, ABOVE_PART)]
    is_apart = near[0] < first_Hz < near[1]
    return [_cycle(plant, law, loop, f) for f in near] if is_apart else []


def nearest(freqs_Hz: tuple[float, ...], freq_Hz: float) -> float:
    return min(freqs_Hz, key=lambda one: abs(one - freq_Hz))


def _cycle(plant: Plant, law: PhaseLaw, loop: ClosedLoop, freq_Hz: float) -> Cycle:
    setting = clearest(law, freq_Hz)
    settle_s = SETTLED_DECAYS * slowest_decay_s(plant.modes, freq_Hz)
    duration_s = LOCKED_s + SETTLINGS * settle_s + FITTED_CYCLES / freq_Hz
    options = ("--set", f"phase_setting={setting}", "--set", "adapt=off", "--noise-mg", "0")
    trace = loop.trace(plant.file, freq_Hz, duration_s, "phase", *options)
    base = loop.run(plant.file, freq_Hz, duration_s, "off")
    return cycle_of(trace, freq_Hz, setting, base["amp_um"], side(plant))


def clearest(law: PhaseLaw, freq_Hz: float) -> str:
    """The setting whose pulse differs more from a constant current there."""

    def gap(name: str) -> float:
        at = next(point for point in law.settings[name] if point.freq_Hz == freq_Hz)
        return (180.0 - at.width_deg) * (at.level_mA - at.floor_mA)

    return max(law.settings, key=gap)


def side(plant: Plant) -> float:
    """-1 where the damper moves against the sensor."""
    mode = plant.modes[0]
    return -1.0 if mode.at_damper * mode.at_sensor < 0.0 else 1.0


def cycle_of(
    trace: Trace, freq_Hz: float, setting: str, uncontrolled_um: float, side: float
) -> Cycle:
    last = trace["t_s"] > trace["t_s"][-1] - FITTED_CYCLES / freq_Hz
    disp_um, coil_A, force_mN = (trace[name][last] for name in ("x5_um", "coil_A", "force_mN"))
    force_mN = side * force_mN
    turn_rad = 2.0 * math.pi * freq_Hz * trace["t_s"][last]
    disp, force = (fundamental(turn_rad, values) for values in (disp_um, force_mN))
    ratio_N_m = 1e3 * force / disp
    turn_deg = np.degrees(turn_rad + np.angle(disp))
    shown = turn_deg > turn_deg[-1] - 360.0
    order = np.argsort(turn_deg[shown] % 360.0)
    shown_at = np.flatnonzero(shown)[order]
    return Cycle(
        freq_Hz,
        setting,
        turn_deg[shown_at] % 360.0,
        *(values[shown_at] for values in (disp_um, coil_A, force_mN)),
        uncontrolled_um,
        float(ratio_N_m.real),
        float(ratio_N_m.imag) / (2.0 * math.pi * freq_Hz),
    )


def fundamental(turn_rad: Floats, values: Floats) -> complex:
    """X of values ~ Re X exp(i turn), harmonics apart."""
    waves = [np.exp(1j * harmonic * turn_rad) for harmonic in HARMONICS]
    columns = [np.ones_like(turn_rad)]
    columns += [part for wave in waves for part in (wave.real, -wave.imag)]
    parts = np.linalg.lstsq(np.column_stack(columns), values, rcond=None)[0]
    return complex(parts[1], parts[2])
