"""A trained model: the parameters that go into a damper file, run by the C++ library."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.library import DamperFile, Scales
from quiesce.damper.model_file import DamperModel

# Called with one line for every piece of work done.
Report = Callable[[str], None]

# Parts by which stroke and speed of a file exceed those of the training data.
_MARGIN = 1.25


def silent(_text: str) -> None:
    """A Report that nobody reads."""


def named(name: str, report: Report) -> Report:
    """Each line after this name."""
    return lambda text: report(f"{name}: {text}")


@dataclass(frozen=True)
class LearnedDamper:
    model: str  # name in damper files
    stroke_m: float
    speed_m_s: float
    parameters: Mapping[str, Any]
    parameter_count: int
    notes: Sequence[str] = field(default=())  # what was done, in plain sentences
    # Settings that a refit to a part of the same rows takes over. What a search found has seen the
    # rows that validate the refit: only where a search of its own costs too much, and docs say so.
    settled: Mapping[str, Any] = field(default_factory=dict)

    def to_toml(self) -> dict[str, Any]:
        """What the [parameters] table holds."""
        return dict(self.parameters)

    def as_model(self, name: str, **more: Any) -> DamperModel:
        """For files; `more`: source, valid, fit."""
        return DamperModel(name, self.model, self.stroke_m, self.speed_m_s, self.parameters, **more)

    @cached_property
    def _damper(self) -> DamperFile:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "damper.toml"
            file.write_text(self.as_model(self.model).to_toml(), encoding="utf-8")
            return DamperFile(file)

    def simulate(self, record: Record) -> np.ndarray:
        """Force in N at the samples, free-running, before the record's moving average."""
        steps = self._damper.substeps(record)
        return self._damper.simulate(library.motion(record), steps)


def limits_of(scales: Scales) -> dict[str, float]:
    """stroke_m and speed_m_s of a model trained on data of these scales."""
    return {
        "stroke_m": _MARGIN * positive(scales.disp_m, "displacement"),
        "speed_m_s": _MARGIN * positive(scales.speed_m_s, "velocity"),
    }


def positive(value: float, what: str) -> float:
    if not (np.isfinite(value) and value > 0.0):
        raise UsageError(f"the {what} is zero throughout; nothing can be learned from it")
    return value
