"""What a fit is worth: its errors, its passivity, and the model file that it becomes."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.damper import library, passivity
from quiesce.damper.candidates import NETWORK, Candidate
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, levels_of
from quiesce.damper.fit.intervals import intervals
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import Fit
from quiesce.damper.fitted import PARAMETRIC, Fitted
from quiesce.damper.library import FIELD, Scales
from quiesce.damper.model_file import DamperModel, from_row
from quiesce.damper.score import Simulate, score
from quiesce.damper.simulate import simulator
from quiesce.damper.task import Parts, Plan
from quiesce.damper.validated import Validated

# Stroke and speed that a model file allows, over those in the data.
MARGIN = 1.25


def judged(
    candidate: Candidate,
    problem: Problem,
    found: Fit,
    checked: Validated,
    parts: Parts,
    plan: Plan,
    seconds: float,
    notes: Sequence[str] = (),
) -> Fitted:
    damper = damper_of(candidate, problem, found, parts, plan)
    damper = replace(damper, fit=fit_table(problem, found, checked))
    simulate = simulator(damper)
    return Fitted(
        candidate.name,
        title_of(candidate),
        PARAMETRIC,
        damper,
        len(problem.variables),
        score(simulate, parts.train),
        checked.error,
        kernel_passivity(damper, parts),
        seconds,
        found.is_complete,
        intervals(problem, found.values) if found.is_complete else [],
        score(simulate, parts.test) if parts.test else None,
        list(dict.fromkeys(notes)),
        checked.folds,
        checked.band,
        checked.coverage(simulate, parts.test),
    )


def damper_of(
    candidate: Candidate, problem: Problem, found: Fit, parts: Parts, plan: Plan
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


def fit_table(problem: Problem, found: Fit, checked: Validated) -> dict[str, Any]:
    band = checked.band
    is_known = band is not None and np.isfinite(band.part)
    return {
        "train_error": found.error,
        "validation_error": checked.error,
        "validation": checked.by_kind,
        **({"band_95": vars(band)} if is_known else {}),
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


def kernel_passivity(damper: DamperModel, parts: Parts) -> passivity.Passivity:
    one, orders, row = damper.kernel_row()
    currents = currents_of(parts.train)
    if passivity.is_proved(one, orders, row, currents):
        return passivity.Passivity(True, 0.0)
    offsets = {"f0_N": [0.0] * orders[one.index("f0_N")]} if "f0_N" in damper.parameters else {}
    keep = {name: value for name, value in damper.rig.items() if name in FIELD}
    alone = replace(damper, parameters={**damper.parameters, **offsets}, rig=keep)
    return passivity.Passivity(False, passivity.trial(simulator(alone), parts.scales, currents))


def without_rest(simulate: Simulate) -> Simulate:
    """Without the force at the first instant, when all is at rest."""

    def run(record: Record) -> np.ndarray:
        force_N = simulate(record)
        return force_N - force_N[0]

    return run
