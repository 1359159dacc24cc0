"""Plants with known truth on which identification is measured, and what a difference costs."""

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomli_w
from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.optimum.periodic import Drive, solve
from quiesce.plant.library import Plant
from quiesce.plant.variant import Variant, changed, read_plant_data
from quiesce.plant_id.find import FoundPlant, find_plant
from quiesce.plant_id.plant_file import modal_shapes
from quiesce.plant_id.simulate import record
from quiesce.plant_id.sweep import SweepPlan, timeline, write_line
from quiesce.tune.pulse import Pulse, tracked

PLANTS = "sim_hil/data/plants"
# Frequencies at which reductions are compared, and a pulse for each: near the best ones of the
# published plant, so that phase, lag and level all count. Centre and width in degrees.
PULSES = {5.0: (118.5, 81.0), 10.0: (100.5, 135.0), 15.0: (43.0, 150.0), 20.0: (49.5, 153.0)}

Change = Callable[[dict[str, Any]], None]


@dataclass(frozen=True)
class Case:
    """A plant made from `plant` by `change`; the unchanged one is the identification's base."""

    name: str
    change: Change = lambda table: None
    plant: str = "squeeze_2012"
    plan: SweepPlan = SweepPlan()
    is_damper_at_sensor: bool = True


def by(variant: Variant) -> Change:
    return lambda table: table.update(changed(table, variant))


def damped(table: dict[str, Any]) -> None:
    for mode, ratio in zip(table["structure"]["mode"], (0.03, 0.03), strict=True):
        mode["damping_ratio"] = ratio


def one_mode(table: dict[str, Any]) -> None:
    del table["structure"]["mode"][1:]


def damper_key(key: str, factor: float) -> Change:
    def change(table: dict[str, Any]) -> None:
        table["damper"][key] *= factor

    return change


def curved(table: dict[str, Any]) -> None:
    """Yield stress rises with I^1.3, the same at full current."""
    damper = table["damper"]
    field = damper["coil_turns"] * table["driver"]["max_current_A"] / (2 * math.pi)
    field /= damper["coil_radius_m"]
    damper["yield_coefficient"] *= field**-0.3
    damper["yield_exponent"] = 1.3


def uneven_lag(table: dict[str, Any]) -> None:
    table["coil"] = {"rise_s": 0.006, "fall_s": 0.003}


FRAME_PLAN = SweepPlan(
    low_Hz=1.0,
    high_Hz=60.0,
    drive_V=0.5,
    dwell_drive_V=0.5,
    dwell_Hz=(4.5, 8.0, 14.0, 20.0),
    max_current_A=2.0,
    hold_s=2.0,
    rest_s=15.0,
)

CASES = (
    Case("nominal"),
    Case("force 0.7", by(Variant(force=0.7))),
    Case("force 1.5", by(Variant(force=1.5))),
    Case("lag 2 ms", by(Variant(rise_s=0.002))),
    Case("lag 10 ms", by(Variant(rise_s=0.010))),
    Case("lag 6/3 ms", uneven_lag),
    Case("frequencies -10 %", by(Variant(freq=0.9))),
    Case("frequencies +10 %", by(Variant(freq=1.1))),
    Case("damping 3 %, 3 %", damped),
    Case("one mode", one_mode),
    Case("force ~ I^1.3", curved),
    Case("gap 1.5 mm, 2 assumed", damper_key("gap_m", 0.75)),
    Case("viscosity x2, x1 assumed", damper_key("viscosity_Pa_s", 2.0)),
    Case("frame, damper elsewhere", plant="frame_3dof", plan=FRAME_PLAN, is_damper_at_sensor=False),
)


@dataclass(frozen=True)
class Compared:
    """Identified against true. Percentages are relative, points are of reductions in %."""

    case: Case
    found: FoundPlant
    freq_pct: float  # worst of the modes
    damping_pct: float  # of mode 1; NaN where it is not comparable
    force_pct: float  # at full current, as it acts on mode 1; NaN likewise
    rise_ms: float
    fall_ms: float
    points: dict[str, float]  # by waveform and metric, worst of the frequencies

    @property
    def worst_points(self) -> float:
        return max(self.points.values())


def write_case(case: Case, folder: Path) -> Path:
    table = copy.deepcopy(read_plant_data(root() / PLANTS / f"{case.plant}.toml"))
    case.change(table)
    file = folder / "true.toml"
    file.write_text(tomli_w.dumps(table), encoding="utf-8")
    return file


def reductions(plant: Plant, freq_Hz: float, drive_V: float, pulse: Pulse) -> tuple[float, ...]:
    """Displacement and acceleration, in %: constant full current, then the pulse."""
    drive = Drive(plant, freq_Hz, drive_V)
    rest = solve(drive, 0.0)
    answers = (solve(drive, plant.max_current_A), tracked(drive, pulse, rest.state))
    return tuple(
        100.0 * (1.0 - part)
        for one in answers
        for part in (one.amp_m / rest.amp_m, one.accel_rms_m_s2 / rest.accel_rms_m_s2)
    )


METRICS = ("constant amp", "constant accel", "pulse amp", "pulse accel")


def reduction_errors(true: Plant, found: Plant) -> dict[str, float]:
    """Largest differences over the frequencies, in points. UsageError where no orbit is found."""
    worst = dict.fromkeys(METRICS, 0.0)
    for freq_Hz, (centre_deg, width_deg) in PULSES.items():
        pulse = Pulse(centre_deg, width_deg, true.max_current_A, 0.0)
        pairs = [reductions(plant, freq_Hz, true.drive_V, pulse) for plant in (true, found)]
        for name, a, b in zip(METRICS, *pairs, strict=True):
            worst[name] = max(worst[name], abs(a - b))
    return worst


def force_on_mode1(table: dict[str, Any], at_damper: float) -> float:
    """Damper force at full current times shape squared: what the recording can tell."""
    damper = table["damper"]
    current_A = table["driver"]["max_current_A"]
    if damper["model"] == "viscous":
        return at_damper**2 * damper["per_A_N_s_m"] * current_A
    field = damper["coil_turns"] * current_A / (2 * math.pi * damper["coil_radius_m"])
    yield_Pa = damper["yield_coefficient"] * field ** damper.get("yield_exponent", 1.0)
    return at_damper**2 * damper["force_scale"] * yield_Pa / damper["gap_m"]


def compare(case: Case, folder: Path, seed: int) -> Compared:
    """Records the case's plant, identifies it, and compares."""
    true_file = write_case(case, folder)
    true = Plant(true_file)
    plan = replace(case.plan, max_current_A=true.max_current_A)
    line = timeline(plan)
    recording = folder / "recording.csv"
    write_line(recording, line, record(true, line, seed))
    base = root() / PLANTS / f"{case.plant}.toml"
    found = find_plant(
        recording,
        folder / "identified",
        base,
        is_damper_at_sensor=case.is_damper_at_sensor,
        tell=lambda _: None,
    )
    return judged(case, true_file, found)


def judged(case: Case, true_file: Path, found: FoundPlant) -> Compared:
    true, plant = Plant(true_file), Plant(found.plant_file)
    pairs = list(zip(plant.modes, true.modes, strict=False))
    if len(plant.modes) != len(true.modes):
        raise UsageError(f"{case.name}: {len(plant.modes)} modes found of {len(true.modes)}")
    true_table, table = read_plant_data(true_file), read_plant_data(found.plant_file)
    damping_pct = 100.0 * abs(pairs[0][0].damping_ratio / pairs[0][1].damping_ratio - 1.0)
    one = modal_shapes(found.base, found.fit.values, 1)[0]
    ratio = force_on_mode1(table, one["at_damper"]) / force_on_mode1(
        true_table, true.modes[0].at_damper
    )
    if not case.is_damper_at_sensor:
        # Shapes elsewhere are known up to their scale: the product over sensor and damper is not.
        # Nor is how the damping without current is divided between damper and structure.
        ratio = damping_pct = math.nan
    return Compared(
        case,
        found,
        max(100.0 * abs(a.freq_Hz / b.freq_Hz - 1.0) for a, b in pairs),
        damping_pct,
        100.0 * (ratio - 1.0),
        1e3 * (plant.rise_s - true.rise_s),
        1e3 * (plant.fall_s - true.fall_s),
        reduction_errors(true, plant),
    )
