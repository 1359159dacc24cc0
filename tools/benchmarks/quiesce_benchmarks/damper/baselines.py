"""Fits that others are compared with: static models, least squares from random starts."""

from collections.abc import Sequence

from quiesce.damper.data.split import Segment
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import Effort, Fit, Progress, from_starts
from quiesce.damper.fit.setting import Setting, nodes_of
from quiesce.damper.library import model

# Enough for each of them to end by its own tolerance.
EFFORT = Effort(polish_evaluations=200)


def fit_baseline(
    name: str,
    segments: Sequence[Segment],
    seed: int,
    starts: int = 20,
    with_lag: bool = False,
    progress: Progress | None = None,
) -> tuple[Problem, Fit]:
    """A model with parameters quadratic in the command (as far as the data have levels), with or
    without the lag of the coil, from random starts."""
    rig = ("rise_s", "fall_s") if with_lag else ()
    problem = Problem(Setting(model(name), nodes_of(segments), rig=rig), segments, "sample")
    return problem, from_starts(problem, seed, starts, EFFORT, progress)
