"""Refits that each leave one fold out, on what they leave out: their errors, and the band that
these make about the model of everything."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.band import Band, band_of, coverage, left_out_of
from quiesce.damper.data.folds import Fold
from quiesce.damper.data.split import Segment
from quiesce.damper.score import Simulate
from quiesce.damper.validation import FoldScore, errors_by_kind, fold_score, forces_on, overall


@dataclass(frozen=True)
class Validated:
    folds: tuple[FoldScore, ...]
    band: Band | None

    @property
    def error(self) -> float:
        return overall(self.by_kind)

    @property
    def by_kind(self) -> dict[str, float]:
        return errors_by_kind(self.folds)

    def coverage(self, simulate: Simulate, test: Sequence[Segment]) -> float | None:
        """Part of the test rows inside the band about the model of everything."""
        if self.band is None or not test or not np.isfinite(self.band.part):
            return None
        return coverage(self.band, test, forces_on(simulate, test))


def validated(simulates: Sequence[Simulate], folds: Sequence[Fold]) -> Validated:
    """simulates: one model for each fold. The band is made without folds that are harder than new
    data; folds_of has others."""
    scores, left_out = [], []
    for simulate, fold in zip(simulates, folds, strict=True):
        with np.errstate(all="ignore"):
            forces_N = forces_on(simulate, fold.validation)
        scores.append(fold_score(fold, forces_N))
        if fold.is_harder:
            continue
        pairs = zip(fold.validation, forces_N, strict=True)
        left_out += [left_out_of(segment, force_N) for segment, force_N in pairs]
    kinds = tuple(dict.fromkeys(one.kind for one in folds if not one.is_harder))
    return Validated(tuple(scores), band_of(left_out, kinds))
