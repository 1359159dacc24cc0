"""Finished models of an interrupted identification, so that it can go on."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.damper.band import Band
from quiesce.damper.candidates import GREY_BOX, NETWORK
from quiesce.damper.data.split import Segment
from quiesce.damper.fit.intervals import Interval
from quiesce.damper.fitted import Fitted
from quiesce.damper.model_file import read_model, write_model
from quiesce.damper.passivity import Passivity
from quiesce.damper.ranking import best
from quiesce.damper.score import score
from quiesce.damper.simulate import simulator
from quiesce.damper.validation import Blocks, FoldScore

FOLDER = "models"
STATE = "state.json"
BEST = "damper.toml"
VERSION = 4


def stamp_of(train: Sequence[Segment], test: Sequence[Segment], options: Any) -> str:
    """Of everything that a fit depends on."""
    digest = hashlib.sha256(f"{VERSION} {options}".encode())
    for part in (train, test):
        for one in part:
            digest.update(f"{one.record.name} {one.first} {one.end} {one.record.rate_Hz}".encode())
            digest.update(f"{one.record.average_samples}".encode())
            for values in (
                one.record.disp_m,
                one.record.velocity_m_s,
                one.record.accel_m_s2,
                one.record.force_N,
                one.record.command,
            ):
                digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


class Store:
    """Model files in DIR/models and, beside them, what else belongs to a fit; DIR/damper.toml is
    the best of them."""

    def __init__(self, folder: Path, stamp: str, names: Sequence[str]) -> None:
        self.out = folder
        self.folder = folder / FOLDER
        self.stamp = stamp
        self.names = list(names)

    def company(self, name: str) -> list[str]:
        """The models that a model's fit depends on: networks start from smaller ones, a grey box
        stands on the best."""
        if name == GREY_BOX:
            return self.names
        return [one for one in self.names if one.startswith(NETWORK) and name.startswith(NETWORK)]

    def keep(self, one: Fitted) -> None:
        write_model(self.folder / f"{one.name}.toml", one.damper)
        state = {
            "stamp": self.stamp,
            "company": self.company(one.name),
            "title": one.title,
            "kind": one.kind,
            "parameter_count": one.parameter_count,
            "validation_error": one.validation_error,
            "passivity": [one.passivity.is_proved, one.passivity.worst],
            "seconds": one.seconds,
            "is_complete": one.is_complete,
            "notes": one.notes,
            "intervals": [list(vars(interval).values()) for interval in one.intervals],
            "folds": [
                [fold.kind, fold.left_out, [[test.error_N2, test.force_N2] for test in fold.tests]]
                for fold in one.folds
            ],
            "band": list(vars(one.band).values()) if one.band else None,
            "coverage": one.coverage,
        }
        with output_files(self.folder) as staging:
            text = json.dumps(state, indent=1)
            (staging / f"{one.name}.{STATE}").write_text(text + "\n", encoding="utf-8")

    def keep_best(self, models: Sequence[Fitted]) -> bool:
        """DIR/damper.toml becomes the best passive one of these; where there is none, there is no
        such file, of an earlier run neither."""
        passive = best(models).get("passive")
        if passive is not None:
            write_model(self.out / BEST, passive.damper)
        else:
            (self.out / BEST).unlink(missing_ok=True)
        return passive is not None

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
        networks = {name for name in names if name.startswith(NETWORK)}
        if not networks <= {one.name for one in found}:  # each needs the one before
            found = [one for one in found if one.name not in networks]
        return found

    def _load(self, name: str, train: Sequence[Segment], test: Sequence[Segment]) -> Fitted | None:
        text = (self.folder / f"{name}.{STATE}").read_text(encoding="utf-8")
        state = json.loads(text)
        is_same = state["stamp"] == self.stamp and state["company"] == self.company(name)
        if not is_same or not state["is_complete"]:
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
            tuple(fold_from(*values) for values in state["folds"]),
            band_from(*state["band"]) if state["band"] else None,
            state["coverage"],
        )


def band_from(part: float, power: float, scale_N: float, kinds: list[str]) -> Band:
    return Band(part, power, scale_N, tuple(kinds))


def fold_from(kind: str, left_out: str, tests: list[list[list[float]]]) -> FoldScore:
    return FoldScore(kind, left_out, tuple(Blocks(tuple(e), tuple(f)) for e, f in tests))
