"""Which tests tell a damper apart: for a stroke, a force, a current and what the rig can do."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.excitation import (
    Excitation,
    chirp,
    ramp_freq_Hz,
    ramps,
    random_motion,
    sine,
    step_current,
    sweep,
    switched_current,
    times,
)

# Part of the half stroke that is used: the ends are for mishaps.
USED_PART = 0.8
# Sines: parts of the largest speed, and of the largest amplitude.
SPEED_PARTS = (0.1, 0.3, 1.0)
AMPLITUDE_PARTS = (1.0, 0.3)
LEVEL_PARTS = (0.0, 0.25, 0.5, 0.75, 1.0)
LEAST_FREQ_Hz = 0.05
CYCLES = 8
# Shortest plateau after a step of the current that shows a lag of some 50 ms.
PLATEAU_s = 0.3
# Heat: of steel and fluid, and how fast a warm damper cools on a rig.
HEAT_J_kg_K = 550.0
COOLING_K_s = 0.02
MOST_HEATING_K = 8.0


@dataclass(frozen=True)
class Damper:
    """What is known of a damper and its rig before it is tested; SI units, all above 0."""

    stroke_m: float  # from end to end
    max_force_N: float
    max_current_A: float
    max_speed_m_s: float
    rig_max_Hz: float
    mass_kg: float  # for the heating

    @property
    def amplitude_m(self) -> float:
        return 0.5 * USED_PART * self.stroke_m

    @property
    def levels_A(self) -> list[float]:
        return [round(part * self.max_current_A, 6) for part in LEVEL_PARTS]


@dataclass(frozen=True)
class Test:
    """One recording. freq_Hz: of sines, that with which a chirp begins, else 0. current_A: None
    where it is switched."""

    __test__ = False  # no test of pytest

    name: str
    kind: str
    amplitude_m: float
    speed_m_s: float
    freq_Hz: float
    current_A: float | None
    duration_s: float
    heating_K: float
    pause_s: float
    seed: int = 0


KINDS = {
    "quasi_static": "friction, yield force and its pre-yield travel, gas spring, offset",
    "sine": "damping over speed, hysteresis over amplitude, and both over the current",
    "sweep": "what depends on frequency: fluid and piston mass, compliance, skew of the channels",
    "steps": "lag of coil and driver, rising and falling; nothing else shows it",
    "random": "held out: whether the model predicts motion that it was not fitted to",
    "random_current": "held out: the same with a switched current",
    "chirp": "held out: a sine of one amplitude whose frequency rises evenly",
    "repeat": "the first sine again: drift by temperature, and the floor of any error",
}


@dataclass(frozen=True)
class Plan:
    damper: Damper
    rate_Hz: float
    tests: list[Test]
    warnings: list[str] = field(default_factory=list)

    @property
    def recording_s(self) -> float:
        return sum(one.duration_s for one in self.tests)

    @property
    def total_s(self) -> float:
        return sum(one.duration_s + one.pause_s for one in self.tests)


def make_plan(damper: Damper, seed: int = 1) -> Plan:
    """Every test in the order in which to run it. UsageError where rig and damper do not fit."""
    check(damper)
    tests = [*quasi_static(damper), *sines(damper), *sweeps(damper), *steps(damper)]
    tests += [*randoms(damper, seed), repeat(tests)]
    return Plan(damper, rate_of(damper), tests, warnings_of(damper, tests))


def check(damper: Damper) -> None:
    reach_m_s = 2.0 * np.pi * damper.rig_max_Hz * damper.amplitude_m
    slowest = SPEED_PARTS[0] * damper.max_speed_m_s
    if reach_m_s < slowest:
        raise UsageError(
            f"at {damper.rig_max_Hz:g} Hz and {1e3 * damper.amplitude_m:.3g} mm the rig reaches "
            f"{reach_m_s:.3g} m/s, not even a tenth of --max-speed-m-s {damper.max_speed_m_s:g}; "
            "lower that, or raise --rig-max-Hz"
        )


def rate_of(damper: Damper) -> float:
    """Rows a second: 25 a period of the fastest motion, and enough for a lag of 5 ms."""
    return max(1000.0, 100.0 * np.ceil(0.25 * damper.rig_max_Hz))


def test_of(
    damper: Damper, kind: str, label: str, amplitude_m: float, speed_m_s: float, duration_s: float,
    current_A: float | None, freq_Hz: float = 0.0, seed: int = 0,
) -> Test:  # fmt: skip
    heating_K = heating(damper, speed_m_s, duration_s, current_A)
    level = "switched" if current_A is None else f"{current_A:g}A"
    return Test(
        f"{label}_{level}", kind, amplitude_m, speed_m_s, freq_Hz, current_A, duration_s, heating_K,
        max(5.0, heating_K / COOLING_K_s), seed,
    )  # fmt: skip


def heating(
    damper: Damper, speed_m_s: float, duration_s: float, current_A: float | None
) -> float:  # fmt: skip
    """Rise of the temperature in K if all work stays in the damper; a guess from above."""
    part = 0.5 if current_A is None else current_A / damper.max_current_A
    force_N = damper.max_force_N * (0.2 + 0.8 * part)
    return force_N * 2.0 / np.pi * speed_m_s * duration_s / (HEAT_J_kg_K * damper.mass_kg)


def quasi_static(damper: Damper) -> list[Test]:
    amplitude = damper.amplitude_m
    speed = max(0.01 * damper.max_speed_m_s, 4.0 * amplitude / 60.0)
    duration_s = 2.0 / ramp_freq_Hz(amplitude, speed)
    return [
        test_of(damper, "quasi_static", "quasi_static", amplitude, speed, duration_s, level_A)
        for level_A in damper.levels_A
    ]


def sines(damper: Damper) -> list[Test]:
    """Amplitudes by speeds by currents, as far as the rig goes."""
    out = []
    for amplitude, freq_Hz in sine_points(damper):
        speed = 2.0 * np.pi * freq_Hz * amplitude
        label = f"sine_{1e3 * amplitude:.3g}mm_{freq_Hz:.3g}Hz"
        duration_s = CYCLES / freq_Hz * max(1, np.ceil(3.0 * freq_Hz / CYCLES))
        out += [
            test_of(damper, "sine", label, amplitude, speed, duration_s, level_A, freq_Hz)
            for level_A in damper.levels_A
        ]
    return out


def sine_points(damper: Damper) -> list[tuple[float, float]]:
    """(amplitude in m, frequency in Hz); where a speed is beyond the rig, its fastest."""
    points: dict[tuple[float, float], None] = {}
    for part in AMPLITUDE_PARTS:
        amplitude = part * damper.amplitude_m
        for speed_part in SPEED_PARTS:
            freq_Hz = speed_part * damper.max_speed_m_s / (2.0 * np.pi * amplitude)
            freq_Hz = float(f"{min(max(freq_Hz, LEAST_FREQ_Hz), damper.rig_max_Hz):.12g}")
            points[(amplitude, freq_Hz)] = None
    return list(points)


def sweeps(damper: Damper) -> list[Test]:
    low_Hz = sweep_low_Hz(damper)
    duration_s = max(15.0, 6.0 / low_Hz)
    return [
        test_of(
            damper, "sweep", "sweep", damper.amplitude_m, fastest(damper), duration_s, level_A
        )  # fmt: skip
        for level_A in damper.levels_A[::2]
    ]


def sweep_low_Hz(damper: Damper) -> float:
    return max(LEAST_FREQ_Hz, min(0.5, 0.05 * damper.rig_max_Hz))


def fastest(damper: Damper) -> float:
    """Speed that rig and damper both allow."""
    return min(damper.max_speed_m_s, 2.0 * np.pi * damper.rig_max_Hz * damper.amplitude_m)


def steps(damper: Damper) -> list[Test]:
    """Speeds slow enough that the stroke leaves a plateau after the step."""
    amplitude = damper.amplitude_m
    speed = min(0.2 * fastest(damper), 0.8 * amplitude / PLATEAU_s)
    duration_s = 6.0 / ramp_freq_Hz(amplitude, speed)
    return [
        test_of(damper, "steps", f"steps_to_{level_A:g}A", amplitude, speed, duration_s, None)
        for level_A in (damper.levels_A[2], damper.levels_A[4])
    ]


def randoms(damper: Damper, seed: int) -> list[Test]:
    amplitude, speed = damper.amplitude_m, fastest(damper)
    found = [
        test_of(damper, "random", "random", amplitude, speed, 20.0, level_A, seed=seed + k)
        for k, level_A in enumerate(damper.levels_A[1::2])
    ]
    switched = test_of(
        damper, "random_current", "random", amplitude, speed, 30.0, None, seed=seed + 10
    )  # fmt: skip
    return [*found, switched]


def repeat(tests: Sequence[Test]) -> Test:
    first = next(one for one in tests if one.kind == "sine" and one.current_A)
    return Test(
        f"repeat_{first.name}", "repeat", first.amplitude_m, first.speed_m_s, first.freq_Hz,
        first.current_A, first.duration_s, first.heating_K, first.pause_s,
    )  # fmt: skip


# What to play


def excitation(plan: Plan, test: Test) -> Excitation:
    """Begins and ends at rest in mid-stroke."""
    damper = plan.damper
    time_s = times(test.duration_s, plan.rate_Hz)
    current_A = np.full(len(time_s), test.current_A or 0.0)
    amplitude, speed = test.amplitude_m, test.speed_m_s
    if test.kind in ("sine", "repeat"):
        disp = sine(time_s, amplitude, test.freq_Hz)
    elif test.kind == "chirp":
        disp = chirp(time_s, amplitude, test.freq_Hz, damper.rig_max_Hz)
    elif test.kind == "sweep":
        disp = sweep(time_s, amplitude, speed, sweep_low_Hz(damper), damper.rig_max_Hz)
    elif test.kind in ("random", "random_current"):
        band_Hz = (0.3, max(0.6, 0.5 * damper.rig_max_Hz))
        disp = random_motion(time_s, amplitude, speed, band_Hz, test.seed)
        if test.kind == "random_current":
            current_A = switched_current(time_s, damper.levels_A, test.seed)
    else:
        disp = ramps(time_s, amplitude, speed)
        if test.kind == "steps":
            current_A = step_current(time_s, amplitude, speed, step_level_A(damper, test))
    return Excitation(time_s, disp, current_A)


def step_level_A(damper: Damper, test: Test) -> float:
    """Of a test of steps, whose name says it."""
    named = [level for level in damper.levels_A if test.name.startswith(f"steps_to_{level:g}A")]
    return named[0]


# What to watch


def needs(plan: Plan) -> list[str]:
    """Sampling and sensors."""
    damper = plan.damper
    smallest_m = min(test.amplitude_m for test in plan.tests)
    return [
        f"sample all channels together at {plan.rate_Hz:g} Hz or more, with the same filter; lags "
        "of coil and driver below 5 ms need more",
        f"displacement: {1e6 * smallest_m / 1000.0:.2g} um or finer (a thousandth of the smallest "
        "amplitude; velocity and acceleration are derived from it)",
        f"force: range {1.25 * damper.max_force_N:.3g} N, resolution "
        f"{1e-3 * damper.max_force_N:.2g} N or finer, zeroed with the damper detached",
        f"current: measured in the coil, not the command; {0.01 * damper.max_current_A:.2g} A or "
        "finer",
        "temperature of the housing, noted at the beginning and the end of each test",
    ]


def warnings_of(damper: Damper, tests: Sequence[Test]) -> list[str]:
    found = []
    hot = [one for one in tests if one.heating_K > MOST_HEATING_K]
    if hot:
        worst = max(hot, key=lambda one: one.heating_K)
        found.append(
            f"{len(hot)} test(s) may warm the damper by more than {MOST_HEATING_K:g} K, "
            f"{worst.name} by up to {worst.heating_K:.0f} K, and a warm damper is weaker: "
            "keep the pauses, or cut the fast tests short"
        )
    reach_m_s = fastest(damper)
    if reach_m_s < 0.99 * damper.max_speed_m_s:
        found.append(
            f"the rig reaches {reach_m_s:.3g} m/s of the {damper.max_speed_m_s:g} m/s asked for: a "
            "model says nothing about what lies above"
        )
    if damper.rig_max_Hz < 5.0:
        found.append(
            f"up to {damper.rig_max_Hz:g} Hz neither the mass of fluid and piston nor a skew of "
            "the channels shows"
        )
    found.append(
        "these tests say nothing about ageing, settling after long rest, or other temperatures"
    )
    return found
