"""From the optimisation's results to a law, its steady state, and the parameters to set."""

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.optimum.goal import Reference
from quiesce.optimum.periodic import Orbit
from quiesce.plant.library import Mode, Plant
from quiesce.tune.phase_table import PhaseLaw, Point
from quiesce.tune.plan import TunePlan
from quiesce.tune.store import TuneStore
from quiesce.tune.tables import judged, table
from quiesce.tune.work import bound_works, candidate_of, figures, pulse_works

# Of a mode's decay time, 1/(damping ratio x angular frequency).
SETTLED_DECAYS = 3.0
# A vibration must last this many settlings, and at least so long, before it is adapted to.
START_SETTLINGS, LEAST_START_MS = 15.0, 10_000
MEASURED_CYCLES, LEAST_MEASURE_MS = 2.0, 1000
MOST_LAG_ms = 1000
MODE_REACH = 1.25  # modes up to this part of the band's end decide how slowly things settle


@dataclass(frozen=True)
class Row:
    """One frequency in the steady state: reductions in % against 0 A, currents in A."""

    freq_Hz: float
    is_between: bool  # between two points of the table
    bounds: dict[str, dict[str, float]] | None  # amp, accel, no_worse; None in between
    constants: list[dict[str, float]]
    settings: dict[str, dict[str, float] | None]  # None: the pulse does not come to rest


def results(plan: TunePlan, store: TuneStore) -> list[dict[str, Any]]:
    """Bounds and constants of each frequency, in order."""
    return [store[work.key] for work in bound_works(plan)]


def best_constant_A(found: list[dict[str, Any]]) -> float:
    """The constant current of least displacement, over all frequencies alike."""
    reductions = np.array([[one["amp_red_pct"] for one in r["constants"]] for r in found])
    return float(found[0]["constants"][int(np.argmax(reductions.mean(axis=0)))]["current_A"])


def make_law(plant: Plant, plan: TunePlan, store: TuneStore, name: str, source: str) -> PhaseLaw:
    works = pulse_works(plan, store)
    tables = {}
    for setting in plan.settings:
        mine = [store[work.key] for work in works if work.name == setting]
        chosen = [[candidate_of(one) for one in found] for found in mine]
        points = table(list(plan.freqs_Hz), chosen, plant.max_current_A)
        tables[setting] = tuple(_shaped(plant, points, point) for point in points)
    unlock_mA = round(1e3 * best_constant_A(results(plan, store)))
    return PhaseLaw(name, source, unlock_mA, tables)


def _shaped(plant: Plant, points: list[Point], point: Point) -> Point:
    """With the ratio of acceleration and displacement that the pulse has on this plant."""
    steady = steady_state(plant, points, point.freq_Hz)
    if steady is None:
        return point
    orbit = steady[1]
    omega_rad_s = 2.0 * math.pi * point.freq_Hz
    shape = orbit.accel_rms_m_s2 / (orbit.amp_m * omega_rad_s**2)
    return replace(point, accel_shape=round(min(shape, 3.9999), 4))


def steady_state(
    plant: Plant, points: list[Point] | tuple[Point, ...], freq_Hz: float
) -> tuple[Reference, Orbit] | None:
    """None where the pulse finds no phase in which it can stay."""
    try:
        return judged(plant, list(points), freq_Hz)
    except UsageError:
        return None


def setting_figures(plant: Plant, law: PhaseLaw, freq_Hz: float) -> dict[str, Any]:
    """Reductions of each setting."""
    found = {name: steady_state(plant, points, freq_Hz) for name, points in law.settings.items()}
    return {name: figures(*steady) if steady else None for name, steady in found.items()}


def rows(plant: Plant, plan: TunePlan, store: TuneStore, law: PhaseLaw) -> list[Row]:
    """Every point of the table, and the middle between every two."""
    found = results(plan, store)
    out = []
    for i, (freq_Hz, result) in enumerate(zip(plan.freqs_Hz, found, strict=True)):
        settings = setting_figures(plant, law, freq_Hz)
        out.append(Row(freq_Hz, False, raised(result, settings), result["constants"], settings))
        if i + 1 < len(found):
            middle_Hz = 0.5 * (freq_Hz + plan.freqs_Hz[i + 1])
            between = setting_figures(plant, law, middle_Hz)
            out.append(Row(middle_Hz, True, None, [], between))
    return out


def raised(result: dict[str, Any], settings: dict[str, Any]) -> dict[str, dict[str, float]]:
    """The bounds, or what a constant current or a pulse has shown to be possible."""
    shown = [*result["bounds"].values(), *result["constants"]]
    shown += [each for each in settings.values() if each]
    calm = [one for one in shown if one["accel_red_pct"] >= -1e-3]
    return {
        "amp": max(shown, key=lambda one: one["amp_red_pct"]),
        "accel": max(shown, key=lambda one: one["accel_red_pct"]),
        "no_worse": max(calm, key=lambda one: one["amp_red_pct"]),
    }


# A board file says these, of each damper; a controller with one does not take them.
OF_BOARD = ("current_lag_ms",)


def parameters(plant: Plant, law: PhaseLaw) -> dict[str, int | str]:
    """What to set on the controller of this plant, by name."""
    band = [point.freq_Hz for points in law.settings.values() for point in points]
    settle_ms = 1e3 * SETTLED_DECAYS * slowest_decay_s(plant.modes, max(band))
    settle_ms = _rounded_up(min(max(settle_ms, 50.0), 60_000.0), 10)
    start_ms = _rounded_up(START_SETTLINGS * settle_ms, 1000)
    measure_ms = _rounded_up(1e3 * MEASURED_CYCLES / min(band), 10)
    full_mA = round(1e3 * plant.max_current_A)
    return {
        "law": "phase",
        "max_current_mA": full_mA,
        "unlock_current_mA": law.unlock_current_mA,
        "constant_current_mA": law.unlock_current_mA,
        "current_lag_ms": lag_ms(plant.rise_s),
        "adapt_settle_ms": settle_ms,
        "adapt_start_ms": min(max(LEAST_START_MS, start_ms), 1_000_000),
        "adapt_measure_ms": min(max(LEAST_MEASURE_MS, measure_ms), 10_000),
    }


def lag_ms(rise_s: float) -> int:
    """Parameter current_lag_ms of a coil with this time constant."""
    return min(round(1e3 * rise_s), MOST_LAG_ms)


def setting_words(values: dict[str, int | str]) -> str:
    return " ".join(f"--set {name}={value}" for name, value in values.items())


def read_settings(file: Path) -> list[str]:
    """NAME=VALUE of each, but for the law, from a file of setting_words. UsageError where it is
    none."""
    try:
        words = file.read_text(encoding="utf-8", errors="replace").split()
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; quiesce tune writes it")
    if set(words[::2]) != {"--set"} or not all("=" in word for word in words[1::2]):
        raise UsageError(f"{shown(file)}: expected --set NAME=VALUE .., as quiesce tune writes it")
    return [word for word in words[1::2] if not word.startswith("law=")]


def slowest_decay_s(modes: tuple[Mode, ...], to_Hz: float) -> float:
    """Of the modes in the band and near it; of the first one where there is none."""
    near = [mode for mode in modes if mode.freq_Hz <= MODE_REACH * to_Hz] or modes[:1]
    return max(1.0 / max(m.damping_ratio * 2.0 * math.pi * m.freq_Hz, 1e-3) for m in near)


def _rounded_up(value: float, step: int) -> int:
    return step * math.ceil(value / step - 1e-9)


def file_stem(name: str) -> str:
    """Usable as a file's name."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", name).strip("._") or "plant"
