"""What one model came to: how `identify` hands results to reports, rankings and files."""

from dataclasses import dataclass, field

from quiesce.damper.band import Band
from quiesce.damper.fit.intervals import Interval
from quiesce.damper.model_file import DamperModel
from quiesce.damper.passivity import Passivity
from quiesce.damper.score import Score
from quiesce.damper.validation import FoldScore

PARAMETRIC = "parametric"
BLACK_BOX = "black box"


@dataclass(frozen=True)
class Fitted:
    """A model fitted to the training part. Errors are ||F - F_model|| / ||F||."""

    name: str  # of the model; variants of one have different names
    title: str
    kind: str  # PARAMETRIC or BLACK_BOX
    damper: DamperModel
    parameter_count: int  # numbers that were fitted
    train: Score
    validation_error: float  # inside the training part, of refits without those rows
    passivity: Passivity
    seconds: float
    is_complete: bool  # neither interrupted nor out of time
    intervals: list[Interval] = field(default_factory=list)  # parametric only
    test: Score | None = None
    notes: list[str] = field(default_factory=list)
    folds: tuple[FoldScore, ...] = ()  # what the validation error is made of
    band: Band | None = None  # about the force, from rows that refits left out
    coverage: float | None = None  # part of the test rows inside it
