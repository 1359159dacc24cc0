"""What `identify` is to do: which models, how hard, and on which rows."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from quiesce.damper.candidates import Choice
from quiesce.damper.data.folds import Fold
from quiesce.damper.data.split import Segment
from quiesce.damper.fitted import Fitted
from quiesce.damper.library import Scales

Told = Callable[[Fitted], None]
Say = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """What to do: candidates by name (parametric_candidates, learned models, GREY_BOX)."""

    names: Sequence[str]
    choice: Choice = Choice()
    seed: int = 1
    seconds: float = 300.0  # for each model
    quick: bool = False
    jobs: int = 2
    source: dict[str, Any] = field(default_factory=dict)  # of the model files
    stop: threading.Event = field(default_factory=threading.Event)


@dataclass(frozen=True)
class Parts:
    train: list[Segment]
    test: list[Segment]
    folds: list[Fold]
    scales: Scales
