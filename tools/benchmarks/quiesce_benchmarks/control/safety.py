"""What a law must not do: feed energy in, be misled by a wrong sign, lose itself over a day."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from quiesce.engine.trace import Trace

from quiesce_benchmarks.control.measures import reduction_pct
from quiesce_benchmarks.control.rig import (
    BALANCED,
    DISPLACEMENT,
    OPEN_LOOP,
    SETTINGS,
    Plant,
    Rig,
    constant,
)
from quiesce_benchmarks.control.scenarios import Scenario, sine, steady
from quiesce_benchmarks.control.steady import SHIPPED_s
from quiesce_benchmarks.seeds import generator

STEADY_s = 20.0
# A day of frequencies in turn, so that trims are learnt, left and found again.
DAY_FREQS_Hz = (5.0, 10.0, 7.3, 15.0, 4.4, 20.0)
HOUR_s = 3600.0
QUIET_s = 300.0  # without faults, at the end and in the run to compare with
FAULT_EVERY_s = (2.0, 8.0)
FAULT_LASTS_s = (0.02, 0.6)
ACKNOWLEDGE_s = 0.01
CLEARING = ("dropout", "stuck", "saturate", "range", "disable")
LATCHED = ("estop", "coil_open", "driver_stuck")
DAY_EVERY_ticks = 200
TRIM_COLUMNS = ("trim_on_mdeg", "trim_off_mdeg", "trim_level_q15")
DAY_COLUMNS = ("t_s", "state", "fault_count", "adapt_state", "adapt_trials", *TRIM_COLUMNS)
RUN_STATE = 2
LEVEL_WHOLE_q15 = 32768


@dataclass(frozen=True)
class Work:
    """Of the damper on the structure, a cycle in the last 2 s: negative takes energy out."""

    plant: str
    freq_Hz: float
    setting: str
    work_uJ: float
    constant_work_uJ: float  # of full constant current

    def row(self) -> dict[str, Any]:
        return asdict(self)


def cycle_work_uJ(figures: dict[str, Any], freq_Hz: float) -> float:
    window = figures["windows"][-1]
    cycles = (window["end_s"] - window["start_s"]) * freq_Hz
    return 1e6 * figures["damper_work_J"] / cycles


def measure_work(rig: Rig, plant: Plant, name: str, freq_Hz: float, setting: str) -> Work:
    law = rig.run(steady(freq_Hz, STEADY_s), rig.judged.control(setting), plant).figures
    held = rig.run(steady(freq_Hz, SHIPPED_s), constant(rig.full_A), plant).figures
    return Work(name, freq_Hz, setting, cycle_work_uJ(law, freq_Hz), cycle_work_uJ(held, freq_Hz))


@dataclass(frozen=True)
class Inverted:
    """The accelerometer's sign is wrong."""

    freq_Hz: float
    setting: str
    amp_pct: float
    unlock_amp_pct: float  # of constant unlock current
    upright_amp_pct: float  # with the right sign

    @property
    def below_unlock_pts(self) -> float:
        return self.unlock_amp_pct - self.amp_pct

    def row(self) -> dict[str, Any]:
        return {**asdict(self), "below_unlock_pts": self.below_unlock_pts}


def measure_inverted(rig: Rig, freq_Hz: float, setting: str) -> Inverted:
    control = rig.judged.control(setting)
    base = rig.run(steady(freq_Hz, SHIPPED_s), OPEN_LOOP).figures["amp_um"]

    def amp_pct(scenario: Scenario, chosen: Any) -> float:
        return reduction_pct(rig.run(scenario, chosen).figures["amp_um"], base)

    return Inverted(
        freq_Hz,
        setting,
        amp_pct(steady(freq_Hz, STEADY_s), control.with_settings("accel_polarity=-1")),
        amp_pct(steady(freq_Hz, SHIPPED_s), constant(rig.unlock_A)),
        amp_pct(steady(freq_Hz, STEADY_s), control),
    )


def day_faults(seed: int, end_s: float) -> tuple[tuple[str, float, float], ...]:
    """Every few seconds one of all kinds; what latches is acknowledged."""
    rng = generator(seed, "faults of a day")
    faults: list[tuple[str, float, float]] = []
    time_s = rng.uniform(*FAULT_EVERY_s)
    while time_s < end_s:
        kind = str(rng.choice([*CLEARING, *LATCHED]))
        duration_s = rng.uniform(*FAULT_LASTS_s)
        faults.append((kind, round(time_s, 3), round(duration_s, 3)))
        if kind in LATCHED:
            over_s = round(time_s + duration_s + 0.1, 3)
            faults.append(("fault_reset", over_s, ACKNOWLEDGE_s))
        time_s += duration_s + rng.uniform(*FAULT_EVERY_s)
    return tuple(faults)


def day(seed: int, duration_s: float) -> Scenario:
    """Ends with the first frequency of the day and QUIET_s without faults."""
    each_s = min(HOUR_s, duration_s / (4 * len(DAY_FREQS_Hz)))
    count = int(duration_s // each_s)
    freqs_Hz = [DAY_FREQS_Hz[i % len(DAY_FREQS_Hz)] for i in range(count)]
    end_s = count * each_s + QUIET_s
    segments = [sine(freq_Hz, duration_s=each_s) for freq_Hz in freqs_Hz]
    segments.append(sine(DAY_FREQS_Hz[0], duration_s=QUIET_s))
    return Scenario(
        "a day of faults",
        end_s,
        tuple(segments),
        ((end_s - 2.0, end_s),),
        feed_current=True,
        faults=day_faults(seed, end_s - QUIET_s),
    )


@dataclass(frozen=True)
class Day:
    """What a day with a fault every few seconds left behind."""

    hours: float
    faults_injected: int
    faults_noticed: int
    trials: int | None  # None: the law does not adapt
    outside_limits: int | None  # samples whose trims are beyond the parameters' limits
    largest_trim_deg: float | None
    least_level: float | None
    final_state_is_run: bool
    amp_pct: float  # at the end
    undisturbed_amp_pct: float  # after QUIET_s from a cold start
    trace: Trace

    @property
    def lost_pts(self) -> float:
        """All of it where the controller does not run any more."""
        return self.undisturbed_amp_pct - (self.amp_pct if self.final_state_is_run else 0.0)

    def row(self) -> dict[str, Any]:
        return {
            **{key: value for key, value in asdict(self).items() if key != "trace"},
            "lost_pts": self.lost_pts,
        }


def outside_limits(trace: Trace, edge_limit_mdeg: int, level_limit_pct: int) -> int:
    """Samples with a trim beyond its limit. Rounding to integers may add a step of an edge's
    unit, 180/65536 degrees."""
    step_mdeg = 3
    edge = np.maximum(np.abs(trace["trim_on_mdeg"]), np.abs(trace["trim_off_mdeg"]))
    level = trace["trim_level_q15"]
    least = LEVEL_WHOLE_q15 * (100 - level_limit_pct) / 100.0 - 1.0
    is_outside = (edge > edge_limit_mdeg + step_mdeg) | (level < least) | (level > LEVEL_WHOLE_q15)
    return int(is_outside.sum())


def measure_day(rig: Rig, seed: int, duration_s: float) -> Day:
    scenario = day(seed, duration_s)
    control = rig.judged.control(BALANCED).with_settings("current_check=on")
    columns = DAY_COLUMNS if rig.judged.adapts else ("t_s", "state", "fault_count")
    run = rig.run_once(scenario, control, rig.plant, columns, DAY_EVERY_ticks)
    trace = run.trace
    assert trace is not None
    base = rig.run(steady(DAY_FREQS_Hz[0], SHIPPED_s), OPEN_LOOP).figures["amp_um"]
    calm = replace(steady(DAY_FREQS_Hz[0], QUIET_s), feed_current=True)
    undisturbed = rig.run(calm, control).figures["amp_um"]
    adapts = rig.judged.adapts
    edges = [np.abs(trace[name]).max() for name in TRIM_COLUMNS[:2]] if adapts else []
    return Day(
        hours=scenario.duration_s / HOUR_s,
        faults_injected=sum(kind != "fault_reset" for kind, *_ in scenario.faults),
        faults_noticed=int(trace["fault_count"][-1]),
        trials=int(trace["adapt_trials"][-1]) if adapts else None,
        outside_limits=outside_limits(
            trace, rig.params["adapt_edge_limit_mdeg"], rig.params["adapt_level_limit_pct"]
        )
        if adapts
        else None,
        largest_trim_deg=1e-3 * float(max(edges)) if adapts else None,
        least_level=float(trace["trim_level_q15"].min()) / LEVEL_WHOLE_q15 if adapts else None,
        final_state_is_run=bool(trace["state"][-1] == RUN_STATE),
        amp_pct=reduction_pct(run.figures["amp_um"], base),
        undisturbed_amp_pct=reduction_pct(undisturbed, base),
        trace=trace,
    )


def worst_work_uJ(results: Sequence[Work]) -> float | None:
    return max((one.work_uJ for one in results), default=None)


def worst_inverted_pts(results: Sequence[Inverted]) -> float:
    """Of setting `displacement`; `balanced` gives some away for acceleration, upright too."""
    return max(one.below_unlock_pts for one in results if one.setting == DISPLACEMENT)


def worst_inversion_pts(results: Sequence[Inverted]) -> float:
    """What the wrong sign itself changes, either setting."""
    return max(abs(one.amp_pct - one.upright_amp_pct) for one in results)


def inverted_pairs(freqs_Hz: Sequence[float]) -> list[tuple[float, str]]:
    return [(freq_Hz, setting) for freq_Hz in freqs_Hz for setting in SETTINGS]
