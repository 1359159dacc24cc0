"""One model fitted: to every fold of the inner validation, then to the whole training part."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from time import monotonic

import numpy as np

from quiesce.damper import library, passivity
from quiesce.damper.candidates import GREY_BOX, NETWORK, Candidate, setting_of
from quiesce.damper.data.split import Segment
from quiesce.damper.fit.grown import grow, grown_fit
from quiesce.damper.fit.problem import Problem, trimmed
from quiesce.damper.fit.rig_terms import (
    Verdict,
    doubtful_terms,
    limits_for,
    told_terms,
    verdicts,
    without,
)
from quiesce.damper.fit.search import Effort, Fit, Progress, polish
from quiesce.damper.fit.setting import Setting
from quiesce.damper.fit.small import fit_small
from quiesce.damper.fitted import BLACK_BOX, Fitted
from quiesce.damper.judge import currents_of, judged, valid_of, without_rest
from quiesce.damper.learned import learner
from quiesce.damper.library import Scales
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate, score
from quiesce.damper.task import Parts, Plan, Say, Told

SAY_EVERY_s = 10.0
CUT_SHORT = "trained briefly: the whole training did not end in time (--time-limit)"
# Least squares with which mass and skew are tried.
_TRIED_EVALUATIONS = 20


def fit_candidate(
    candidate: Candidate,
    parts: Parts,
    plan: Plan,
    before: list[tuple[Problem, Fit]] | None,
    say: Say,
) -> tuple[Fitted, list[tuple[Problem, Fit]]]:
    """Fits every fold and the whole training part; `before`: the same of the candidate that this
    one grows from."""
    start_s = monotonic()
    progress = saying(candidate.name, say)
    errors, fits = [], []
    last: tuple[Problem, Fit] | None = None
    notes: list[str] = []
    for k, (rows, validation) in enumerate([*parts.folds, (parts.train, [])]):
        smaller = before[k] if before is not None else None
        # A fold must not start from one that has seen its validation rows.
        known = None if validation else last
        left_s = (plan.seconds - (monotonic() - start_s)) / (len(parts.folds) + 1 - k)
        setting = setting_of(candidate, parts.train, plan.choice)
        fit = RigFit(candidate, rows, plan, [smaller, known], left_s, progress)
        problem, found, notes = fit.with_rig(setting)
        fits.append((problem, found))
        last = (problem, found)
        if validation:
            errors.append(score(simulate_values(problem, found.values), validation).mean_error)
    problem, found = fits[-1]
    seconds = monotonic() - start_s
    return judged(candidate, problem, found, errors, parts, plan, seconds, notes), fits


@dataclass
class RigFit:
    """One candidate against one set of rows, first without the terms of the rig that have to earn
    their place. known: fits to start from, of the smaller model and of other rows."""

    candidate: Candidate
    rows: Sequence[Segment]
    plan: Plan
    known: Sequence[tuple[Problem, Fit] | None]
    seconds: float
    progress: Progress

    def __post_init__(self) -> None:
        self.start_s = monotonic()

    def with_rig(self, setting: Setting) -> tuple[Problem, Fit, list[str]]:
        """The fit, and notes on terms that the data ask for and that are left out."""
        choice = self.plan.choice
        if choice.rig is not None or choice.method != "default":
            return *self.fitted(setting, self.known), []
        doubtful = doubtful_terms(setting)
        bare = self.fitted(without(setting, doubtful), self.known)
        terms = told_terms(doubtful, self.rows)
        if not terms or not bare[1].is_complete:
            return *bare, []
        tried = without(self.limited(setting, terms), [n for n in doubtful if n not in terms])
        found = self.tried(tried, bare, terms)
        notes = [one.note for one in found if one.note]
        kept = [one.name for one in found if one.is_kept]
        # One that is implausible shows that the model lacks something; the other would mimic it.
        if notes or not kept:
            return *bare, notes
        dropped = [name for name in terms if name not in kept]
        again = self.fitted(without(tried, dropped), [*self.known, bare])
        still = verdicts(again[0], again[1].values, kept)
        if not all(one.is_kept for one in still) or again[1].error >= bare[1].error:
            return *bare, notes + [one.note for one in still if one.note]
        return *again, notes

    def limited(self, setting: Setting, terms: Sequence[str]) -> Setting:
        limits = limits_for(self.rows, self.plan.choice.bounds)
        return replace(setting, bounds={**setting.bounds, **{name: limits[name] for name in terms}})

    def tried(
        self, setting: Setting, bare: tuple[Problem, Fit], terms: Sequence[str]
    ) -> list[Verdict]:
        """Verdicts from least squares that go on from the fit without the terms."""
        problem = self.problem_of(setting)
        start = grow(problem, np.zeros((1, len(problem.variables))), *bare)[0]
        values, _ = polish(problem, start, _TRIED_EVALUATIONS, self.is_over)
        return verdicts(problem, values, terms)

    def fitted(
        self, setting: Setting, known: Sequence[tuple[Problem, Fit] | None]
    ) -> tuple[Problem, Fit]:
        problem = self.problem_of(setting)
        left_s = self.seconds - (monotonic() - self.start_s)
        return problem, fit_problem(
            self.candidate, problem, self.plan, known, left_s, self.progress
        )

    def problem_of(self, setting: Setting) -> Problem:
        return Problem(setting, self.rows, "test" if len(self.rows) > 1 else "sample")

    def is_over(self) -> bool:
        return self.plan.stop.is_set() or monotonic() - self.start_s > self.seconds


def fit_problem(
    candidate: Candidate,
    problem: Problem,
    plan: Plan,
    known: Sequence[tuple[Problem, Fit] | None],
    left_s: float,
    progress: Progress,
) -> Fit:
    effort = Effort(
        population=16 if plan.quick else 32,
        generations=8 if plan.quick else 20,
        polished=2 if plan.quick else 4,
        polish_evaluations=20 if plan.quick else 50,
        seconds=max(1.0, left_s),
        stop=plan.stop,
    )
    if plan.choice.method != "default":
        return paper_method(plan.choice.method)(problem, plan.seed, effort, progress)
    if candidate.model.startswith(NETWORK):
        return grown_fit(problem, plan.seed, known, effort, progress)
    start = np.zeros((1, len(problem.variables)))
    starts = [grow(problem, start, *one) for one in known if one is not None]
    values = np.concatenate(starts) if starts else None
    return fit_small(problem, plan.seed, effort, progress, values)


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


class Stopped(Exception):
    pass


def keep_learned(
    name: str,
    parts: Parts,
    plan: Plan,
    bases: Sequence[DamperModel],
    keep: Told,
    say: Say,
) -> None:
    """A learned model, half trained, is worth nothing; so one that is trained briefly comes first,
    whatever the time, and stands where the whole training does not end in time."""
    try:
        brief = fit_learned(name, parts, plan, bases, is_brief=True)
    except Stopped:
        say(f"{name}: left out, stopped")
        return
    if plan.quick:
        keep(brief)
        return
    say(f"{name}: trained briefly, validation {100.0 * brief.validation_error:.2f} %; goes on")
    try:
        keep(fit_learned(name, parts, plan, bases))
    except Stopped:
        keep(replace(brief, is_complete=False, notes=[*brief.notes, CUT_SHORT]))


def fit_learned(
    name: str,
    parts: Parts,
    plan: Plan,
    bases: Sequence[DamperModel] = (),
    is_brief: bool = False,
) -> Fitted:
    """bases: what a grey box stands on, fitted to each fold and to the whole training part. Stopped
    where time runs out; a brief training ends only with the plan."""
    module = learner("hysteresis_network" if name == GREY_BOX else name)
    usual = module.BRIEF if is_brief else module.Settings()
    start_s = monotonic()
    errors = []
    trained = None

    def going_on(_text: str) -> None:
        is_late = not is_brief and monotonic() - start_s > plan.seconds
        if plan.stop.is_set() or is_late:
            raise Stopped

    for k, (rows, validation) in enumerate([*parts.folds, (parts.train, [])]):
        settings = replace(usual, base=bases[k]) if bases else usual
        # What follows the rows of a fold validates it: not even its size may be known.
        own = trimmed(rows)
        trained = module.train(own, Scales.of(own), plan.seed, settings, going_on)
        if validation:
            errors.append(score(trained.simulate, validation).mean_error)
    damper = trained.as_model(name, source=plan.source, valid=valid_of(parts.train))
    worst = passivity.trial(without_rest(trained.simulate), parts.scales, currents_of(parts.train))
    return Fitted(
        name,
        title_learned(name),
        BLACK_BOX,
        damper,
        trained.parameter_count,
        score(trained.simulate, parts.train),
        float(np.mean(errors)),
        passivity.Passivity(False, worst),
        monotonic() - start_s,
        True,
        [],
        score(trained.simulate, parts.test) if parts.test else None,
        list(trained.notes),
    )


def title_learned(name: str) -> str:
    return name.replace("_", " ")
