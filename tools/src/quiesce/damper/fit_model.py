"""One model fitted: to every fold of the inner validation, then to the whole training part."""

from collections.abc import Callable, Sequence
from functools import partial
from time import monotonic

import numpy as np

from quiesce.damper import library, passivity
from quiesce.damper.candidates import GREY_BOX, NETWORK, Candidate, setting_of
from quiesce.damper.fit.grown import grown_fit
from quiesce.damper.fit.problem import Problem, trimmed
from quiesce.damper.fit.search import Effort, Fit, Progress
from quiesce.damper.fit.small import fit_small
from quiesce.damper.fitted import BLACK_BOX, Fitted
from quiesce.damper.judge import currents_of, judged, valid_of, without_rest
from quiesce.damper.learned import learner
from quiesce.damper.library import Scales
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate, score
from quiesce.damper.task import Parts, Plan, Say, Told

SAY_EVERY_s = 10.0


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
    for k, (rows, validation) in enumerate([*parts.folds, (parts.train, [])]):
        setting = setting_of(candidate, parts.train, plan.choice)
        problem = Problem(setting, rows, "test" if len(rows) > 1 else "sample")
        smaller = before[k] if before is not None else None
        # A fold must not start from one that has seen its validation rows.
        known = None if validation else last
        left_s = (plan.seconds - (monotonic() - start_s)) / (len(parts.folds) + 1 - k)
        found = fit_problem(candidate, problem, plan, smaller, known, left_s, progress)
        fits.append((problem, found))
        last = (problem, found)
        if validation:
            errors.append(score(simulate_values(problem, found.values), validation).mean_error)
    problem, found = fits[-1]
    return judged(candidate, problem, found, errors, parts, plan, monotonic() - start_s), fits


def fit_problem(
    candidate: Candidate,
    problem: Problem,
    plan: Plan,
    smaller: tuple[Problem, Fit] | None,
    last: tuple[Problem, Fit] | None,
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
        return grown_fit(problem, plan.seed, [smaller, last], effort, progress)
    known = None if last is None else last[1].values[None, :]
    return fit_small(problem, plan.seed, effort, progress, known)


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
    """A learned model is worth nothing half trained: out of time, it is left out."""
    try:
        keep(fit_learned(name, parts, plan, bases))
    except Stopped:
        say(f"{name}: left out, its training did not end in time")


def fit_learned(name: str, parts: Parts, plan: Plan, bases: Sequence[DamperModel] = ()) -> Fitted:
    """bases: what a grey box stands on, fitted to each fold and to the whole training part."""
    module = learner("hysteresis_network" if name == GREY_BOX else name)
    start_s = monotonic()
    errors = []
    trained = None

    def going_on(_text: str) -> None:
        if plan.stop.is_set() or monotonic() - start_s > plan.seconds:
            raise Stopped

    for k, (rows, validation) in enumerate([*parts.folds, (parts.train, [])]):
        settings = module.Settings(base=bases[k]) if bases else module.Settings()
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
