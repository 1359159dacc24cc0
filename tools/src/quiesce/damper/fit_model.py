"""One parametric model fitted: to the whole training part, then to what every fold of the
validation leaves of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from time import monotonic

import numpy as np

from quiesce.damper import library
from quiesce.damper.candidates import NETWORK, Candidate, setting_of
from quiesce.damper.data.folds import Fold
from quiesce.damper.data.split import Segment, records_in
from quiesce.damper.fit.grown import grow, grown_fit
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.rig_terms import (
    DOUBTFUL,
    doubtful_terms,
    limits_for,
    told_terms,
    verdicts,
    without,
)
from quiesce.damper.fit.search import Effort, Fit, Progress, polish
from quiesce.damper.fit.setting import Setting
from quiesce.damper.fit.small import fit_small
from quiesce.damper.fitted import Fitted
from quiesce.damper.judge import damper_of, judged
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate
from quiesce.damper.task import Parts, Plan, Say
from quiesce.damper.validated import validated

SAY_EVERY_s = 10.0
# Of a model's time, what the fit to everything may take.
_WHOLE_PART = 0.7
# Least squares of a refit that leaves a fold out, from the fit to everything.
_REFIT_EVALUATIONS, _REFIT_EVALUATIONS_QUICK = 15, 8
_REFIT_TOLERANCE = 1e-6
# By this part less error a fit to a part of the rows shows that the one to everything had not
# ended.
_BETTER = 1e-3
# Least squares with which mass and skew are tried.
_TRIED_EVALUATIONS = 20


def fit_candidate(
    candidate: Candidate,
    parts: Parts,
    plan: Plan,
    smaller: tuple[Problem, Fit] | None,
    say: Say,
) -> tuple[Fitted, tuple[Problem, Fit], list[DamperModel]]:
    """The whole training part first, then refits that leave each fold out; `smaller`: the fit of
    the candidate that this one grows from. Returned with the fit and the models of the folds."""
    start_s = monotonic()
    progress = saying(candidate.name, say)
    setting = setting_of(candidate, parts.train, plan.choice)
    fit = RigFit(candidate, parts.train, plan, smaller, _WHOLE_PART * plan.seconds, progress)
    problem, found, notes = fit.with_rig(setting)
    refits = []
    for k, fold in enumerate(parts.folds):
        left_s = (plan.seconds - (monotonic() - start_s)) / (len(parts.folds) - k)
        again = Refit(candidate, fold, plan, max(1.0, left_s), progress)
        refits.append(again.of(problem, found))
        progress(f"without {fold.left_out}, {k + 1} of {len(parts.folds)} to validate", found.error)
    simulates = [simulate_values(own, one.values) for own, one in refits]
    checked = validated(simulates, parts.folds)
    is_complete = found.is_complete and all(one.is_complete for _, one in refits)
    found = replace(fit.gone_on_from(refits, (problem, found)), is_complete=is_complete)
    seconds = monotonic() - start_s
    fitted = judged(candidate, problem, found, checked, parts, plan, seconds, notes)
    dampers = [damper_of(candidate, *one, parts, plan) for one in refits]
    return fitted, (problem, found), dampers


@dataclass
class Refit:
    """A candidate fitted again to what a fold leaves, from its fit to everything: a few steps of
    least squares. Current laws are those that the fold's own rows can tell; which terms of the rig
    are in was decided on all rows. What the fold's rows do not determine stays where it was, so
    an error may be a little too good, never by the validation's own residual."""

    candidate: Candidate
    fold: Fold
    plan: Plan
    seconds: float
    progress: Progress

    def of(self, whole: Problem, found: Fit) -> tuple[Problem, Fit]:
        problem = Problem(self.setting(whole.setting), self.fold.fit, weigh_of(self.fold.fit))
        if self.plan.choice.method != "default":
            method = paper_method(self.plan.choice.method)
            effort = effort_of(self.plan, self.seconds)
            return problem, method(problem, self.plan.seed, effort, self.progress)
        return problem, self.polished(problem, whole, found)

    def setting(self, whole: Setting) -> Setting:
        own = setting_of(self.candidate, self.fold.fit, self.plan.choice)
        if self.plan.choice.rig is not None:
            return own
        dropped = [name for name in doubtful_terms(own) if name not in whole.rig]
        kept = {name: whole.bounds[name] for name in DOUBTFUL if name in whole.bounds}
        own = without(own, dropped)
        return replace(
            own, bounds={**own.bounds, **{k: v for k, v in kept.items() if k in own.rig}}
        )

    def polished(self, problem: Problem, whole: Problem, found: Fit) -> Fit:
        start_s = monotonic()

        def is_over() -> bool:
            return self.plan.stop.is_set() or monotonic() - start_s > self.seconds

        middle = problem.values_from(np.full((1, len(problem.nonlinear)), 0.5))
        start, errors = problem.project(grow(problem, middle, whole, found))
        most = _REFIT_EVALUATIONS_QUICK if self.plan.quick else _REFIT_EVALUATIONS
        values, error = polish(problem, start[0], most, is_over, _REFIT_TOLERANCE)
        if not error < errors[0]:
            values, error = start[0], float(errors[0])
        seconds = monotonic() - start_s
        return Fit(values, error, problem.evaluations, seconds, not is_over())


def weigh_of(rows: Sequence[Segment]) -> str:
    return "test" if len(records_in(rows)) > 1 else "sample"


@dataclass
class RigFit:
    """One candidate against one set of rows, first without the terms of the rig that have to earn
    their place. smaller: a fit to start from, of the model that this one grows from."""

    candidate: Candidate
    rows: Sequence[Segment]
    plan: Plan
    smaller: tuple[Problem, Fit] | None
    seconds: float
    progress: Progress

    def __post_init__(self) -> None:
        self.start_s = monotonic()

    def with_rig(self, setting: Setting) -> tuple[Problem, Fit, list[str]]:
        """The fit, and notes on terms that the data ask for and that are left out."""
        choice = self.plan.choice
        if choice.rig is not None or choice.method != "default":
            return *self.fitted(setting), []
        doubtful = doubtful_terms(setting)
        bare = self.fitted(without(setting, doubtful))
        terms = told_terms(doubtful, self.rows)
        if not terms or not bare[1].is_complete:
            return *bare, []
        tried = without(self.limited(setting, terms), [n for n in doubtful if n not in terms])
        on_trial = self.gone_on(tried, bare, _TRIED_EVALUATIONS)
        found = verdicts(on_trial[0], on_trial[1].values, terms)
        notes = [one.note for one in found if one.note]
        kept = [one.name for one in found if one.is_kept]
        # One that is implausible shows that the model lacks something; the other would mimic it.
        if notes or not kept:
            return *bare, notes
        dropped = [name for name in terms if name not in kept]
        most = effort_of(self.plan, self.seconds).polish_evaluations
        again = self.gone_on(without(tried, dropped), on_trial, most)
        still = verdicts(again[0], again[1].values, kept)
        if not all(one.is_kept for one in still) or again[1].error >= bare[1].error:
            return *bare, notes + [one.note for one in still if one.note]
        return *again, notes

    def limited(self, setting: Setting, terms: Sequence[str]) -> Setting:
        limits = limits_for(self.rows, self.plan.choice.bounds)
        return replace(setting, bounds={**setting.bounds, **{name: limits[name] for name in terms}})

    def gone_on(
        self, setting: Setting, before: tuple[Problem, Fit], most: int
    ) -> tuple[Problem, Fit]:
        """Least squares that go on from a fit of other terms: at most `most` evaluations."""
        problem = self.problem_of(setting)
        start = grow(problem, np.zeros((1, len(problem.variables))), *before)[0]
        values, error = polish(problem, start, most, self.is_over)
        seconds = monotonic() - self.start_s
        return problem, Fit(values, error, problem.evaluations, seconds, not self.is_over())

    def gone_on_from(
        self, refits: Sequence[tuple[Problem, Fit]], whole: tuple[Problem, Fit]
    ) -> Fit:
        """The fit to everything, or where one to a part of it has led to a better one, least
        squares from there."""
        problem, found = whole
        if self.plan.choice.method != "default" or not refits:
            return found
        known = found.values[None, :]
        starts = np.concatenate([grow(problem, known, *one) for one in refits])
        errors = [problem.error(values) for values in starts]
        best = int(np.argmin(errors))
        if not errors[best] < (1.0 - _BETTER) * found.error:
            return found

        def is_over() -> bool:
            is_late = monotonic() - self.start_s > self.plan.seconds
            return self.plan.stop.is_set() or is_late

        most = effort_of(self.plan, self.seconds).polish_evaluations
        values, error = polish(problem, starts[best], most, is_over)
        if not error < found.error:
            return found
        return replace(found, values=values, error=error, evaluations=problem.evaluations)

    def fitted(self, setting: Setting) -> tuple[Problem, Fit]:
        problem = self.problem_of(setting)
        left_s = self.seconds - (monotonic() - self.start_s)
        return problem, fit_problem(
            self.candidate, problem, self.plan, self.smaller, left_s, self.progress
        )

    def problem_of(self, setting: Setting) -> Problem:
        return Problem(setting, self.rows, weigh_of(self.rows))

    def is_over(self) -> bool:
        return self.plan.stop.is_set() or monotonic() - self.start_s > self.seconds


def fit_problem(
    candidate: Candidate,
    problem: Problem,
    plan: Plan,
    smaller: tuple[Problem, Fit] | None,
    left_s: float,
    progress: Progress,
) -> Fit:
    effort = effort_of(plan, left_s)
    if plan.choice.method != "default":
        return paper_method(plan.choice.method)(problem, plan.seed, effort, progress)
    if candidate.model.startswith(NETWORK):
        return grown_fit(problem, plan.seed, smaller, effort, progress)
    start = np.zeros((1, len(problem.variables)))
    values = None if smaller is None else grow(problem, start, *smaller)
    return fit_small(problem, plan.seed, effort, progress, values)


def effort_of(plan: Plan, left_s: float) -> Effort:
    return Effort(
        population=16 if plan.quick else 32,
        generations=8 if plan.quick else 20,
        polished=2 if plan.quick else 4,
        polish_evaluations=20 if plan.quick else 50,
        seconds=max(1.0, left_s),
        stop=plan.stop,
    )


def saying(name: str, say: Say) -> Progress:
    """Tells of a long fit every SAY_EVERY_s."""
    last_s = monotonic()

    def tell(what: str, error: float) -> None:
        nonlocal last_s
        if monotonic() - last_s >= SAY_EVERY_s:
            last_s = monotonic()
            say(f"{name}: {what}, error {100.0 * error:.2f} %")

    return tell


def paper_method(name: str) -> Callable[[Problem, int, Effort, Progress], Fit]:
    """The searches that the papers used, over all variables."""
    from quiesce.damper.fit.binary_ga import fit_binary_ga, fit_plain_ga
    from quiesce.damper.fit.named import fit_named
    from quiesce.damper.fit.thesis_de import fit_thesis_de

    own = {"ga": fit_binary_ga, "ga-plain": fit_plain_ga, "de": fit_thesis_de}
    return own[name] if name in own else partial(fit_named, name)


def simulate_values(problem: Problem, values: np.ndarray) -> Simulate:
    row = problem.rows(values)[0]
    return lambda record: library.simulate_row(problem.model, problem.orders, row, record)
