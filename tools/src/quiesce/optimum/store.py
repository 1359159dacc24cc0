"""Bounds and best constant currents, computed in parallel and kept in a JSON file.

Each result is stored as it arrives, under a key of the plant's content, frequency and drive; what
the file already holds is not computed again.
"""

import copy
import hashlib
import json
import tempfile
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.base.pools import Processes
from quiesce.base.progress import Progress
from quiesce.base.runner import run_each
from quiesce.optimum.bound import INTERVALS, STARTS, bound
from quiesce.optimum.constant import best_constant
from quiesce.optimum.goal import ACCEL, AMP, NO_WORSE, Reference, reference
from quiesce.optimum.periodic import Orbit, drive
from quiesce.plant.library import Plant
from quiesce.plant.variant import Variant, read_plant_data, write_variant

SCHEMA = "quiesce-bounds"
SETTINGS = {"intervals": INTERVALS, "starts": STARTS}
MATTERS = ("structure", "place", "mount", "damper", "driver", "coil", "shaker", "integration")


@dataclass(frozen=True)
class Case:
    """One plant at one frequency."""

    plant: Path
    variant: Variant
    freq_Hz: float
    goals: tuple[str, ...]  # of GOALS

    @property
    def name(self) -> str:
        return f"{self.variant.name} {self.freq_Hz:g} Hz"


GOALS = {"amp": AMP, "accel": ACCEL, "no_worse": NO_WORSE}


def plant_hash(data: dict[str, Any]) -> str:
    """Of what decides a plant's steady state under the shaker, but for the drive."""
    parts = {key: copy.deepcopy(data[key]) for key in MATTERS if key in data}
    parts["shaker"].pop("drive_V", None)
    parts["driver"].pop("bits", None)
    if "mount" not in parts:
        parts.pop("place", None)
    parts["structure"].setdefault("mode", [])
    if "gain_m_s2_V" not in parts["shaker"]:
        _without_base(parts["structure"])
    text = json.dumps(parts, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _without_base(structure: dict[str, Any]) -> None:
    """What a force does is the same however the structure would move with its base."""
    structure.pop("base", None)
    for mode in structure["mode"]:
        mode.pop("base_participation", None)


def case_key(plant: Path, freq_Hz: float, drive_V: float | None = None) -> str:
    """drive_V: the plant file's where it is None."""
    data = read_plant_data(plant)
    drive_V = data["shaker"]["drive_V"] if drive_V is None else drive_V
    return f"{plant_hash(data)} {freq_Hz:g} Hz {drive_V:g} V"


class BoundStore:
    """The JSON file. A file of other settings is refused, not mixed with."""

    def __init__(self, file: Path, command: str = "") -> None:
        self._file = file
        self._data: dict[str, Any] = {
            "schema": SCHEMA,
            "version": 1,
            "command": command,
            "settings": SETTINGS,
            "cases": {},
        }
        if file.exists():
            self._data = self._read(file)

    @staticmethod
    def _read(file: Path) -> dict[str, Any]:
        try:
            data = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise UsageError(f"{shown(file)}: cannot be read as bounds: {error}")
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            raise UsageError(f"{shown(file)}: schema: not {SCHEMA!r}; name a file of bounds")
        if data.get("settings") != SETTINGS:
            raise UsageError(f"{shown(file)}: settings: allowed are {SETTINGS}; name a new file")
        return data

    def get(self, key: str) -> dict[str, Any] | None:
        return self._data["cases"].get(key)

    def has(self, key: str, goals: Iterable[str]) -> bool:
        return all(goal in self._data["cases"].get(key, {}) for goal in goals)

    def put(self, key: str, value: dict[str, Any]) -> None:
        cases = self._data["cases"]
        cases[key] = {**cases.get(key, {}), **value}
        self._data["cases"] = dict(sorted(cases.items(), key=lambda item: _order(item[0])))
        self._file.parent.mkdir(parents=True, exist_ok=True)
        staging = self._file.with_suffix(".part")
        staging.write_text(json.dumps(self._data, indent=1) + "\n", encoding="utf-8")
        staging.replace(self._file)


def _order(key: str) -> tuple[str, float, str]:
    plant, freq, _, *rest = key.split()
    return plant, float(freq), " ".join(rest)


def figures(ref: Reference, orbit: Orbit) -> dict[str, float]:
    return {
        "amp_red_pct": round(ref.amp_reduction_pct(orbit), 3),
        "accel_red_pct": round(ref.accel_reduction_pct(orbit), 3),
        "mean_current_A": round(orbit.mean_current_A, 4),
    }


def compute(case: Case) -> tuple[str, dict[str, Any]]:
    """Key and value of one case."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "plant.toml"
        write_variant(case.plant, case.variant, file)
        key = case_key(file, case.freq_Hz)
        plant = Plant(file)
    ref = reference(drive(plant, case.freq_Hz))
    value: dict[str, Any] = {
        "variant": case.variant.name,
        "uncontrolled": {
            "amp_um": round(1e6 * ref.orbit.amp_m, 4),
            "accel_rms_mm_s2": round(1e3 * ref.orbit.accel_rms_m_s2, 4),
        },
    }
    for name in ("amp", "accel"):
        constant = best_constant(ref.drive, GOALS[name])
        current_A = round(constant.current_A, 3)
        value[f"constant_{name}"] = {"current_A": current_A, **figures(ref, constant.orbit)}
    for name in case.goals:
        # A limit that the best displacement keeps anyway changes nothing.
        is_kept = name == "no_worse" and value["amp"]["accel_red_pct"] >= 0.0
        value[name] = value["amp"] if is_kept else figures(ref, bound(ref.drive, GOALS[name]).orbit)
    return key, value


def compute_all(store: BoundStore, cases: list[Case], workers: int) -> None:
    """Computes what the store does not hold yet."""
    todo = [case for case in cases if not store.has(_key(case), case.goals)]
    progress = Progress(len(todo))

    def keep(number: int, result: tuple[str, dict[str, Any]]) -> None:
        store.put(*result)
        progress.done(todo[number].name)

    with closing(Processes(workers)) as pool:
        run_each(pool, [(compute, (case,)) for case in todo], keep)


def _key(case: Case) -> str:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "plant.toml"
        write_variant(case.plant, case.variant, file)
        return case_key(file, case.freq_Hz)
