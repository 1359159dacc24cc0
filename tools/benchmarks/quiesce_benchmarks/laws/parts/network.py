"""Networks in the controller: integers beside float64, inverses of dampers in the loop with the
firmware's own tracker, and what knowing the fluid's temperature is worth."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.damper.data.record import Record
from quiesce.damper.inverses import feed_forward, mapped, network, svr
from quiesce.damper.inverses.demand import Inverse, Source, judged
from quiesce.damper.inverses.excited import excited
from quiesce.damper.inverses.mapped import MapInverse
from quiesce.damper.inverses.networks import NetworkInverse
from quiesce.damper.inverses.tracking import CONSTANT, IDEAL, compare, tasks_for
from quiesce.damper.simulate import simulator_of_file
from quiesce.law.forms.network import NetworkTable
from quiesce.network import radial

from quiesce_benchmarks.laws.firmware_laws import NetworkTracker, demands
from quiesce_benchmarks.papers import thermal_loop
from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.seeds import generator

TITLE = "networks: integers, inverses in the loop, and the damper's temperature"
FIGURES = (
    ("network_float_error_pct", "%", 1.0, "lower"),
    ("network_over_map", "error over the map's, worst damper", 1.0, "lower"),
    ("network_tracking_error_pct", "%", None, "lower"),
    ("svr_tracking_error_pct", "%", None, "lower"),
    ("svr_hot_with_temperature_pct", "%", None, "lower"),
    ("svr_hot_over_blind", "-", 1.0, "lower"),
)
DAMPERS = {"rd1005_kwok_tanh_smooth": 1.8, "rd1005_kwok_bouc_wen": 1.5}
TEMPERATURES_C = [15.0, 35.0, 55.0, 75.0, 95.0]
HEAT_CAPACITY_J_K = 10.0  # a fiftieth of a damper's: the same warm-up in less time
KNOWING, BLIND, MAP = "with temperature", "without", "map, made at 25 C"


@dataclass(frozen=True)
class InFirmware:
    """An inverse as the controller's own tracker works it off."""

    inverse: NetworkInverse

    @property
    def max_current_A(self) -> float:
        return self.inverse.max_current_A

    def currents(self, demand: Record) -> np.ndarray:
        return NetworkTracker(self.inverse.table).currents_A(values_of(self.inverse, demand))

    def parameters(self) -> dict[str, Any]:
        return self.inverse.parameters()


def values_of(inverse: NetworkInverse, demand: Record) -> np.ndarray:
    """[ticks, inputs] in SI units."""
    columns = {
        "demand": demand.force_N,
        "stroke": demand.disp_m,
        "stroke velocity": demand.velocity_m_s,
        "temperature": demand.temperature_C,
    }
    names = [one.signal.quantity.name for one in inverse.table.sections[0].inputs]
    return np.stack([columns[name] for name in names], axis=1)


def float_error_pct(inverse: NetworkInverse, demands_N: list[Record]) -> float:
    """Largest difference over the range that is covered, of the tracker, on whole units."""
    inputs = inverse.table.sections[0].inputs
    units = np.array([one.signal.quantity.per_unit for one in inputs])
    apart, covered = 0.0, 0.0
    for one in demands_N:
        values = np.rint(values_of(inverse, one) * units) / units
        exact = inverse.table.currents_A(values)[:, 0]
        ours = NetworkTracker(inverse.table).currents_A(values)
        apart = max(apart, float(np.abs(ours - exact).max()))
        covered = max(covered, float(np.ptp(exact)))
    return 100.0 * apart / covered


def law_error_pct(inverse: NetworkInverse, seed: int) -> float:
    """Of the law: Gaussians and rules that imitate a skyhook's current from stroke and velocity."""
    rng = generator(seed, "network", "law")
    spans = inverse.table.sections[0].inputs[1:3]
    x = rng.uniform(-1.0, 1.0, (4000, 2))
    target = np.clip(x[:, 0] * x[:, 1] + 0.5 * np.abs(x[:, 1]), 0.0, 1.0)
    ends = [np.array([one.low, one.high]) / one.signal.quantity.per_unit for one in spans]
    values = np.stack([np.interp(x[:, k], [-1.0, 1.0], end) for k, end in enumerate(ends)], axis=1)
    worst = 0.0
    for of_rules in (False, True):
        found, _ = radial.fitted(x, target, 12, rng, of_rules)
        section = replace(
            inverse.table.sections[0], inputs=spans, delay_ticks=0, rate_Hz=0, least_um_s=0,
            largest_mA=2000, layers=found.layers(2000.0),
        )  # fmt: skip
        table = NetworkTable((section,))
        # Beside what was fitted, before its weights were rounded.
        exact = np.clip(2.0 * found.parts(x), 0.0, 2.0)
        apart = np.abs(demands(table, values)[:, 0] - exact).max()
        worst = max(worst, 100.0 * float(apart / np.ptp(exact)))
    return worst


# Inverses in the loop


@dataclass(frozen=True)
class Tracked:
    damper: str
    error_pct: dict[str, float]
    float_error_pct: float


def tracked(damper: str, most_A: float, seed: int, seconds: float) -> Tracked:
    model, simulate = simulator_of_file(root() / f"sim_hil/data/dampers/{damper}.toml")
    source = Source(excited(model, simulate, most_A, seed), most_A, model)
    made = {one.NAME: one.make(source, seed) for one in (network, svr)}
    inverses: dict[str, Inverse] = {name: InFirmware(one) for name, one in made.items()}
    inverses["map"] = mapped.make(source)
    inverses["ffn"] = feed_forward.make(source, seed)
    found = compare(model, simulate, inverses, most_A, seed, seconds)
    tasks = [judged(one.demand) for one in tasks_for(model, simulate, most_A, seed, seconds)]
    apart = max(float_error_pct(one, tasks) for one in made.values())
    apart = max(apart, law_error_pct(made["network"], seed))
    return Tracked(damper, found.errors_pct(), apart)


def tracked_table(all_of_them: list[Tracked]) -> str:
    names = ["network", "svr", "map", "ffn", CONSTANT, IDEAL]
    rows = [
        [one.damper, *(f"{one.error_pct[name]:.1f}" for name in names),
         f"{one.float_error_pct:.3f}"]
        for one in all_of_them
    ]  # fmt: skip
    return format_table(["force error, %", *names, "integers off, %"], rows, (0,))


# Temperature


def in_firmware(inverse: NetworkInverse) -> thermal_loop.Tracker:
    tracker = NetworkTracker(inverse.table)
    names = [one.signal.quantity.name for one in inverse.table.sections[0].inputs]

    def current_A(
        wanted_N: float, stroke_m: float, velocity_m_s: float, fluid_C: float, held_A: float
    ) -> float:
        seen = {"demand": wanted_N, "stroke": stroke_m, "stroke velocity": velocity_m_s,
                "temperature": fluid_C}  # fmt: skip
        return float(tracker.currents_A(np.array([[seen[name] for name in names]]))[0])

    return current_A


def by_map(inverse: MapInverse) -> thermal_loop.Tracker:
    def current_A(
        wanted_N: float, stroke_m: float, velocity_m_s: float, fluid_C: float, held_A: float
    ) -> float:
        one = np.zeros(1)
        record = Record("now", 500.0, one, one + stroke_m, one + velocity_m_s, one,
                        one + wanted_N, one, "A")  # fmt: skip
        wanted = judged(record)
        return float(inverse.currents(wanted)[0]) if wanted.force_N[0] else 0.0

    return current_A


def thermal_trackers(seed: int) -> dict[str, Callable]:
    records = thermal_loop.rig_records(generator(seed, "network", "rig"), TEMPERATURES_C)
    source = Source(thermal_loop.whole(records), thermal_loop.MAX_A)
    model, _ = simulator_of_file(root() / thermal_loop.DAMPER)
    return {
        KNOWING: in_firmware(svr.make(source, seed, with_temperature=True)),
        BLIND: in_firmware(svr.make(source, seed, with_temperature=False)),
        MAP: by_map(mapped.make(Source([], thermal_loop.MAX_A, model))),
    }


def warm_up(seed: int, seconds: float) -> dict[str, list[float]]:
    """Error in % of each quarter of a warm-up, by tracker; then the fluid's mean there."""
    base_m_s2 = thermal_loop.road(generator(seed, "network", "road"), seconds)
    quarter = len(base_m_s2) // 4
    out: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        plant = thermal_loop.write_plant(Path(folder), HEAT_CAPACITY_J_K)
        for name, tracker in thermal_trackers(seed).items():
            noise = generator(seed, "network", "noise")
            loop = thermal_loop.run(plant, base_m_s2, tracker, noise)
            rows = [slice(k * quarter, (k + 1) * quarter) for k in range(4)]
            out[name] = [100.0 * thermal_loop.error_of(loop, one) for one in rows]
            out["fluid, C"] = [float(np.mean(loop.fluid_C[one])) for one in rows]
    return out


def warm_table(found: dict[str, list[float]]) -> str:
    rows = [[name, *(f"{value:.1f}" for value in values)] for name, values in found.items()]
    return format_table(["force error, %, by quarter", "1", "2", "3", "4"], rows, (0,))


def measure(effort: Effort) -> Measured:
    chosen = list(DAMPERS.items())[: 1 if effort.is_quick else None]
    seconds = 3.0 if effort.is_quick else 8.0
    found = [tracked(name, most_A, effort.seed, seconds) for name, most_A in chosen]
    warm = warm_up(effort.seed, 16.0 if effort.is_quick else 60.0)

    def worst(name: str) -> float:
        return max(one.error_pct[name] for one in found)

    values: dict[str, float | None] = {
        "network_float_error_pct": max(one.float_error_pct for one in found),
        "network_over_map": max(one.error_pct["network"] / one.error_pct["map"] for one in found),
        "network_tracking_error_pct": worst("network"),
        "svr_tracking_error_pct": worst("svr"),
        "svr_hot_with_temperature_pct": warm[KNOWING][-1],
        "svr_hot_over_blind": warm[KNOWING][-1] / warm[BLIND][-1],
    }
    reported = {"dampers": [vars(one) for one in found], "warm_up": warm}
    return Measured(values, reported, (tracked_table(found), warm_table(warm)))
