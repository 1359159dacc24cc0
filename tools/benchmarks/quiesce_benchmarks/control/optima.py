"""Own optimal control: bounds from committed caches, found by what a plant file says."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import root, shown

FOLDER = "docs/results/bounds"
COMMAND = "python -m quiesce_benchmarks.control.bounds"


class Optima:
    """Stored results by plant and frequency; of several stores the first that has it."""

    def __init__(self, files: Sequence[Path]) -> None:
        """UsageError where a file is no store."""
        # Imported late: it brings scipy's optimisers, which no other command waits for.
        from quiesce.optimum.store import BoundStore, case_key

        self._stores = [BoundStore(file) for file in files]
        self._key = case_key

    def reductions(self, plant_file: Path, freq_Hz: float) -> dict[str, dict[str, float]]:
        """By goal: amp, accel, no_worse; of each amp_red_pct, accel_red_pct, mean_current_A.

        Empty where the plant at this frequency is in no store.
        """
        key = self._key(plant_file, freq_Hz)
        merged: dict[str, Any] = {}
        for store in reversed(self._stores):
            merged |= store.get(key) or {}
        return {goal: merged[goal] for goal in ("amp", "accel", "no_worse") if goal in merged}


def load_optima(given: Sequence[Path]) -> Optima:
    """Those that ship with the project, and those that the user names."""
    for file in given:
        if not file.is_file():
            raise UsageError(f"--bounds {shown(file)}: no such file; make one with {COMMAND}")
    return Optima([*given, *sorted((root() / FOLDER).glob("*.json"))])
