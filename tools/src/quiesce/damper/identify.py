"""Every model that was asked for, fitted, validated inside the training part, and judged."""

import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from quiesce.damper import library, passivity
from quiesce.damper.candidates import (
    NETWORK,
    Candidate,
    Choice,
    parametric_candidates,
    setting_of,
)
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Fold, Segment, inner_split, levels_of
from quiesce.damper.fit.grown import grown_fit
from quiesce.damper.fit.intervals import intervals
from quiesce.damper.fit.problem import Problem, trimmed
from quiesce.damper.fit.search import Effort, Fit, Progress
from quiesce.damper.fit.small import fit_small
from quiesce.damper.fitted import BLACK_BOX, PARAMETRIC, Fitted, simulator
from quiesce.damper.library import FIELD, Scales
from quiesce.damper.model_file import DamperModel, from_row
from quiesce.damper.ranking import ranked
from quiesce.damper.score import Simulate, score

# Stroke and speed that a model file allows, over those in the data.
MARGIN = 1.25
# Folds of the inner validation at most.
MOST_FOLDS = 2
SAY_EVERY_s = 10.0
GREY_BOX = "grey_box"

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
class _Parts:
    train: list[Segment]
    test: list[Segment]
    folds: list[Fold]
    scales: Scales


def all_names() -> list[str]:
    from quiesce.damper.learned import MODELS

    return [*parametric_candidates(), *MODELS, GREY_BOX]


def identify(
    train: Sequence[Segment],
    test: Sequence[Segment],
    plan: Plan,
    done: Sequence[Fitted] = (),
    told: Told = lambda _one: None,
    say: Say = lambda _text: None,
) -> list[Fitted]:
    """The models of `plan`, `done` (from an earlier run) included; told: called as each is ready.
    When plan.stop is set, models under way end with their best so far, others are left out."""
    # Cut off what follows the training rows: nothing of it may reach a fit or a choice.
    own = trimmed(train)
    folds = inner_split(own)
    parts = _Parts(
        own,
        list(test),
        folds[:: max(1, len(folds) // MOST_FOLDS)][:MOST_FOLDS],
        Scales.of(own),
    )
    results = {one.name: one for one in done}
    by_fold: dict[str, list[DamperModel]] = {}
    lock = threading.Lock()

    def keep(one: Fitted) -> None:
        with lock:
            results[one.name] = one
            told(one)

    chains, grey = chains_of([name for name in plan.names if name not in results])
    with ThreadPoolExecutor(plan.jobs) as pool:
        futures = [
            pool.submit(run_chain, chain, parts, plan, by_fold, keep, say) for chain in chains
        ]
        try:
            for future in futures:
                future.result()
        except BaseException:
            plan.stop.set()
            for future in futures:
                future.cancel()
            raise
    if grey and not plan.stop.is_set():
        run_grey_box(list(results.values()), parts, plan, by_fold, keep, say)
    return [results[name] for name in [*plan.names] if name in results]


def chains_of(names: Sequence[str]) -> tuple[list[list[Candidate | str]], bool]:
    """Lists to be done one after the other; and whether a grey box comes at the end. Long ones come
    first, so that the short ones fill the gaps."""
    known = parametric_candidates()
    networks: list[Candidate | str] = []
    single: list[list[Candidate | str]] = []
    for name in names:
        if name.startswith(NETWORK):
            networks.append(known[name])
        elif name != GREY_BOX:
            single.append([known.get(name, name)])
    return [networks, *single] if networks else single, GREY_BOX in names


def run_chain(
    chain: Sequence[Candidate | str],
    parts: _Parts,
    plan: Plan,
    by_fold: dict[str, list[DamperModel]],
    keep: Told,
    say: Say,
) -> None:
    before: list[tuple[Problem, Fit]] | None = None
    for one in chain:
        if plan.stop.is_set():
            return
        if isinstance(one, str):
            keep_learned(one, parts, plan, (), keep, say)
        else:
            fitted, before = fit_candidate(one, parts, plan, before, say)
            by_fold[one.name] = [damper_of(one, *fit, parts, plan) for fit in before[:-1]]
            keep(fitted)


# Models with named parameters


def fit_candidate(
    candidate: Candidate,
    parts: _Parts,
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
    from quiesce.damper.fit.binary_ga import fit_binary_ga
    from quiesce.damper.fit.thesis_de import fit_thesis_de

    return {"ga": fit_binary_ga, "de": fit_thesis_de}[name]


def simulate_values(problem: Problem, values: np.ndarray) -> Simulate:
    row = problem.rows(values)[0]
    return lambda record: library.simulate_row(problem.model, problem.orders, row, record)


def judged(
    candidate: Candidate,
    problem: Problem,
    found: Fit,
    errors: Sequence[float],
    parts: _Parts,
    plan: Plan,
    seconds: float,
) -> Fitted:
    damper = damper_of(candidate, problem, found, parts, plan)
    damper = replace(damper, fit=fit_table(problem, found, errors))
    simulate = simulator(damper)
    return Fitted(
        candidate.name,
        title_of(candidate),
        PARAMETRIC,
        damper,
        len(problem.variables),
        score(simulate, parts.train),
        float(np.mean(errors)),
        kernel_passivity(damper, parts),
        seconds,
        found.is_complete,
        intervals(problem, found.values) if found.is_complete else [],
        score(simulate, parts.test) if parts.test else None,
    )


def damper_of(
    candidate: Candidate, problem: Problem, found: Fit, parts: _Parts, plan: Plan
) -> DamperModel:
    return from_row(
        problem.model,
        problem.orders,
        problem.rows(found.values)[0],
        candidate.name,
        MARGIN * parts.scales.disp_m,
        MARGIN * parts.scales.speed_m_s,
        source=plan.source,
        valid=valid_of(parts.train),
    )


def title_of(candidate: Candidate) -> str:
    free = candidate.model.startswith(NETWORK) and not candidate.is_passive
    return library.model(candidate.model).title + (", stiffness of either sign" if free else "")


def fit_table(problem: Problem, found: Fit, errors: Sequence[float]) -> dict[str, Any]:
    return {
        "train_error": found.error,
        "validation_error": float(np.mean(errors)),
        "evaluations": found.evaluations,
        "is_complete": found.is_complete,
        "data": [Path(segment.record.name).name for segment in problem.segments],
    }


def valid_of(segments: Sequence[Segment]) -> dict[str, Any]:
    """Ranges in the data."""
    commands = np.concatenate([one.record.command[one.rows] for one in segments])
    scales = Scales.of(segments)
    key = "current_A" if segments[0].record.command_unit == "A" else "command_V"
    levels = levels_of(segments)
    ends = (levels[0], levels[-1]) if levels else (commands.min(), commands.max())
    return {
        key: [float(ends[0]), float(ends[1])],
        "stroke_m": scales.disp_m,
        "speed_m_s": scales.speed_m_s,
        "force_N": scales.force_N,
    }


def currents_of(segments: Sequence[Segment]) -> list[float]:
    levels = levels_of(segments)
    if len(levels) >= 2:
        return [levels[0], levels[len(levels) // 2], levels[-1]]
    commands = np.concatenate([one.record.command for one in segments])
    return sorted({float(np.quantile(commands, part)) for part in (0.02, 0.5, 0.98)})


def kernel_passivity(damper: DamperModel, parts: _Parts) -> passivity.Passivity:
    one, orders, row = damper.kernel_row()
    currents = currents_of(parts.train)
    if passivity.is_proved(one, orders, row, currents):
        return passivity.Passivity(True, 0.0)
    offsets = {"f0_N": [0.0] * orders[one.index("f0_N")]} if "f0_N" in damper.parameters else {}
    keep = {name: value for name, value in damper.rig.items() if name in FIELD}
    alone = replace(damper, parameters={**damper.parameters, **offsets}, rig=keep)
    return passivity.Passivity(False, passivity.trial(simulator(alone), parts.scales, currents))


# Learned models


class _Stopped(Exception):
    pass


def keep_learned(
    name: str,
    parts: _Parts,
    plan: Plan,
    bases: Sequence[DamperModel],
    keep: Told,
    say: Say,
) -> None:
    """A learned model is worth nothing half trained: out of time, it is left out."""
    try:
        keep(fit_learned(name, parts, plan, bases))
    except _Stopped:
        say(f"{name}: left out, its training did not end in time")


def fit_learned(name: str, parts: _Parts, plan: Plan, bases: Sequence[DamperModel] = ()) -> Fitted:
    """bases: what a grey box stands on, fitted to each fold and to the whole training part."""
    from quiesce.damper.learned import learner

    module = learner("hysteresis_network" if name == GREY_BOX else name)
    start_s = monotonic()
    errors = []
    trained = None

    def going_on(_text: str) -> None:
        if plan.stop.is_set() or monotonic() - start_s > plan.seconds:
            raise _Stopped

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


def without_rest(simulate: Simulate) -> Simulate:
    """Without the force at the first instant, when all is at rest."""

    def run(record: Record) -> np.ndarray:
        force_N = simulate(record)
        return force_N - force_N[0]

    return run


def run_grey_box(
    results: Sequence[Fitted],
    parts: _Parts,
    plan: Plan,
    by_fold: dict[str, list[DamperModel]],
    keep: Told,
    say: Say,
) -> None:
    """A network on top of the best parametric model. What validates it stands on a base that has
    not seen the validation rows either."""
    parametric = [one for one in results if one.kind == PARAMETRIC]
    if not parametric:
        return
    base = ranked(parametric)[0]
    if base.name not in by_fold:  # from an earlier run
        candidate = parametric_candidates()[base.name]
        _, fits = fit_candidate(candidate, parts, plan, None, say)
        by_fold[base.name] = [damper_of(candidate, *one, parts, plan) for one in fits[:-1]]
    say(f"{GREY_BOX}: learning what {base.name} leaves")
    keep_learned(GREY_BOX, parts, plan, [*by_fold[base.name], base.damper], keep, say)
