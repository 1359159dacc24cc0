"""Is the model that validation puts first also the best on a current, a motion, an amplitude that
nothing has seen? And how many of its rows lie inside the 95 % band?"""

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from quiesce.base.errors import BenchFailure
from quiesce.base.progress import Progress
from quiesce.base.table import format_table
from quiesce.damper.candidates import names_of
from quiesce.damper.fitted import Fitted
from quiesce.damper.identify import identify
from quiesce.damper.ranking import ranked
from quiesce.damper.task import Plan

from quiesce_benchmarks.damper.benchmark import no_data
from quiesce_benchmarks.damper.real import data_folder
from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.unseen.cases import Case, all_cases
from quiesce_benchmarks.unseen.judged_cases import JudgedCases

TITLE = "ranking and bands on whole currents, motions and amplitudes left out"
# Of bands both too narrow and too wide are misses.
MOST_COVERED_pct = 99.0
# Judged, and no check fails by them before all cases were run once with all models.
FIGURES = (
    ("rank_regret_mean_pct", "%", 10.0, "lower", False),
    ("rank_regret_worst_pct", "%", 30.0, "lower", False),
    ("interval_coverage_pct", "%", 90.0, "higher", False),
    ("interval_coverage_over_99_pct", "%", 0.0, "lower", False),
)
# A model's time where nothing is to be cut short.
_ENDLESS_s = 1e6


@dataclass(frozen=True)
class Judged:
    """One case: the model that validation chose and the one that the held-out tests would have."""

    case: Case
    chosen: str
    best: str
    chosen_error: float
    best_error: float
    coverage: float | None

    @property
    def regret_pct(self) -> float:
        return 100.0 * (self.chosen_error / max(self.best_error, 1e-300) - 1.0)


def measure(effort: Effort) -> Measured:
    """--quick: the default models with little effort; otherwise all of them, untruncated: hours.
    A run that is stopped goes on with the cases that are left (judged_cases.py)."""
    folder = data_folder()
    if folder is None:
        raise BenchFailure(no_data())
    names = names_of("quick" if effort.is_quick else "all")
    cases = all_cases(folder, effort.is_quick)
    kept = JudgedCases.of(folder, {"models": names, "seed": effort.seed, "quick": effort.is_quick})
    progress = Progress(len(cases))
    found = []
    for case in cases:
        known = kept.get(case.name)
        if known is not None:
            found.append(Judged(case, **known))
            progress.done(f"{case.name}: judged before")
            continue
        plan = Plan(
            names, seed=effort.seed, seconds=_ENDLESS_s, quick=effort.is_quick,
            jobs=os.cpu_count() or 1,
        )  # fmt: skip
        one = judged(case, identify(case.held.fit, case.held.validation, plan))
        kept.put(case.name, {key: value for key, value in vars(one).items() if key != "case"})
        progress.done(f"{case.name}: {one.chosen}, {one.regret_pct:.1f} % above the best")
        found.append(one)
    return measured(found)


def judged(case: Case, fitted: Sequence[Fitted]) -> Judged:
    """The held-out tests are read here, once, after everything was chosen."""
    errors = {one.name: one.test.mean_error for one in fitted if one.test is not None}
    best = min(errors, key=lambda name: errors[name])
    first = ranked(fitted)[0]
    return Judged(case, first.name, best, errors[first.name], errors[best], first.coverage)


def measured(found: Sequence[Judged]) -> Measured:
    regrets = [one.regret_pct for one in found]
    covered = [100.0 * one.coverage for one in found if one.coverage is not None]
    coverage_pct = float(np.mean(covered)) if covered else None
    values = {
        "rank_regret_mean_pct": float(np.mean(regrets)),
        "rank_regret_worst_pct": float(np.max(regrets)),
        "interval_coverage_pct": coverage_pct,
        "interval_coverage_over_99_pct": None
        if coverage_pct is None
        else max(0.0, coverage_pct - MOST_COVERED_pct),
    }
    rows = [
        [
            one.case.name,
            one.case.held.kind,
            one.chosen,
            f"{100.0 * one.chosen_error:.2f}",
            one.best,
            f"{100.0 * one.best_error:.2f}",
            f"{one.regret_pct:.1f}",
            "-" if one.coverage is None else f"{100.0 * one.coverage:.1f}",
        ]
        for one in found
    ]
    head = ["held out", "kind", "chosen", "test %", "best", "test %", "regret %", "in band %"]
    cases = [
        {
            "held_out": one.case.name, "kind": one.case.held.kind, "chosen": one.chosen,
            "chosen_error": one.chosen_error, "best": one.best, "best_error": one.best_error,
            "coverage": one.coverage,
        }
        for one in found
    ]  # fmt: skip
    return Measured(values, {"cases": cases}, (format_table(head, rows, left=(0, 1, 2, 4)),))
