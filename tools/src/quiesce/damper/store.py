"""Finished models of an interrupted identification, so that it can go on."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.atomic import output_files
from quiesce.damper.data.split import Segment
from quiesce.damper.fit.intervals import Interval
from quiesce.damper.fitted import Fitted, simulator
from quiesce.damper.model_file import read_model, write_model
from quiesce.damper.passivity import Passivity
from quiesce.damper.score import score
from quiesce.errors import UsageError

FOLDER = "models"
STATE = "state.json"
VERSION = 1


def stamp_of(train: Sequence[Segment], test: Sequence[Segment], options: Any) -> str:
    """Of everything that a fit depends on."""
    digest = hashlib.sha256(f"{VERSION} {options}".encode())
    for part in (train, test):
        for one in part:
            digest.update(f"{one.record.name} {one.first} {one.end} {one.record.rate_Hz}".encode())
            for values in (one.record.disp_m, one.record.force_N, one.record.command):
                digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


class Store:
    """Model files in DIR/models and, beside them, what else belongs to a fit."""

    def __init__(self, folder: Path, stamp: str) -> None:
        self.folder = folder / FOLDER
        self.stamp = stamp

    def keep(self, one: Fitted) -> None:
        write_model(self.folder / f"{one.name}.toml", one.damper)
        state = {
            "stamp": self.stamp,
            "title": one.title,
            "kind": one.kind,
            "parameter_count": one.parameter_count,
            "validation_error": one.validation_error,
            "passivity": [one.passivity.is_proved, one.passivity.worst],
            "seconds": one.seconds,
            "is_complete": one.is_complete,
            "notes": one.notes,
            "intervals": [list(vars(interval).values()) for interval in one.intervals],
        }
        with output_files(self.folder) as staging:
            text = json.dumps(state, indent=1)
            (staging / f"{one.name}.{STATE}").write_text(text + "\n", encoding="utf-8")

    def finished(
        self, names: Sequence[str], train: Sequence[Segment], test: Sequence[Segment]
    ) -> list[Fitted]:
        """What is there, complete, and of the same data and options."""
        found = []
        for name in names:
            try:
                one = self._load(name, train, test)
            except (UsageError, OSError, ValueError, KeyError, TypeError):
                continue
            if one is not None:
                found.append(one)
        return found

    def _load(self, name: str, train: Sequence[Segment], test: Sequence[Segment]) -> Fitted | None:
        text = (self.folder / f"{name}.{STATE}").read_text(encoding="utf-8")
        state = json.loads(text)
        if state["stamp"] != self.stamp or not state["is_complete"]:
            return None
        damper = read_model(self.folder / f"{name}.toml")
        simulate = simulator(damper)
        return Fitted(
            name,
            state["title"],
            state["kind"],
            damper,
            state["parameter_count"],
            score(simulate, train),
            state["validation_error"],
            Passivity(*state["passivity"]),
            state["seconds"],
            True,
            [Interval(*values) for values in state["intervals"]],
            score(simulate, test) if test else None,
            state["notes"],
        )
