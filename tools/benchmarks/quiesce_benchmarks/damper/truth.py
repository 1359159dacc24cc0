"""Are the parameters of every model found again from its own force?

One truth of every kernel of the library (see damper_truth_cases), four short tests. First, before
any fit, the Cramer-Rao standard deviation of each parameter at 1 % noise. Then fits from scratch
without noise and with it, by fit_small and a polish; it knows nothing of the truth and starts again
with another seed while the residual is neither white nor negligible. Last the 95 % intervals: for
each of many noise seeds a least-squares fit that starts at the truth, since it is the interval that
is tested there and not the search.

The elements of a network may come out in another order, which is the same damper: the order that
fits the truth best counts.
"""

import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

import numpy as np
from quiesce.base.progress import Progress
from quiesce.base.table import format_table
from quiesce.damper import library
from quiesce.damper.candidates import NETWORK
from quiesce.damper.fit.intervals import intervals, whiteness
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import Effort, polish
from quiesce.damper.fit.small import EXPLAINED, fit_small

from quiesce_benchmarks.damper import truth_c3
from quiesce_benchmarks.damper.truth_cases import DETERMINED, NOISE_PART, Truth, make_truth
from quiesce_benchmarks.report import Figure

EXACT_GOAL_pct = 1.0
NOISY_GOAL_pct = 5.0
JUDGED_pct = 1.5  # Cramer-Rao: parameters below it are judged with noise
COVERAGE_GOAL_pct = (90.0, 99.0)
ATTEMPTS = 3
EFFORT = Effort(population=32, generations=20, seconds=120.0)
POLISH_EVALUATIONS = 200
SEED_EVALUATIONS = 8

Say = Callable[[str], None]


@dataclass(frozen=True)
class Size:
    models: tuple[str, ...]  # () all
    fits: int  # from scratch, with noise
    seeds: int  # of the intervals


FULL = Size((), 2, 100)
QUICK = Size(("bingham", "kwok_tanh", "viscous_dahl", "normalised_bouc_wen", "zhang_tanh"), 1, 100)


@dataclass(frozen=True)
class ParameterResult:
    """Relative to the truth, in %. coverage_pct: how often the 95 % interval holds the truth; None
    where the parameter is not judged."""

    name: str
    unit: str
    truth: float
    deviation_pct: float  # Cramer-Rao, 1 % noise
    exact_error_pct: float
    noisy_error_pct: float  # largest of the fits
    coverage_pct: float | None

    @property
    def is_determined(self) -> bool:
        """By the tests; what they do not determine cannot be found."""
        return self.deviation_pct <= 100.0 * DETERMINED

    @property
    def is_judged(self) -> bool:
        return self.deviation_pct <= JUDGED_pct


@dataclass(frozen=True)
class ModelResult:
    name: str
    parameters: Sequence[ParameterResult]
    evaluations: int  # of the fit without noise

    @property
    def coverage_pct(self) -> float | None:
        found = [one.coverage_pct for one in self.parameters if one.coverage_pct is not None]
        return float(np.mean(found)) if found else None


def measure_model(name: str, size: Size, say: Say, seed: int = 1) -> ModelResult:
    truth = make_truth(library.model(name), seed)
    exact = truth.problem()
    values = truth.values(exact)
    deviations_pct = 100.0 * truth.deviations()
    numbers = ", ".join(
        f"{one.name} {pct:.2g}" for one, pct in zip(exact.variables, deviations_pct, strict=True)
    )
    say(f"{name}: Cramer-Rao at 1 % noise, in %: {numbers}")
    exact_pct = errors_pct(exact, fit_from_scratch(exact, seed), values)
    evaluations = exact.evaluations
    noisy_pct = np.zeros(len(values))
    for k in range(size.fits):
        noisy = truth.problem(NOISE_PART, 1000 + k)
        found_pct = errors_pct(noisy, fit_from_scratch(noisy, seed + k), values)
        noisy_pct = np.maximum(noisy_pct, found_pct)
    held = coverage(truth, values, size.seeds) if np.any(deviations_pct <= JUDGED_pct) else None
    parameters = [
        ParameterResult(
            one.name,
            one.unit,
            float(values[k]),
            float(deviations_pct[k]),
            float(exact_pct[k]),
            float(noisy_pct[k]),
            float(100.0 * held[k]) if held is not None and is_judged(deviations_pct[k]) else None,
        )
        for k, one in enumerate(exact.variables)
    ]
    return ModelResult(name, parameters, evaluations)


def is_judged(deviation_pct: float) -> bool:
    return bool(deviation_pct <= JUDGED_pct)


def fit_from_scratch(problem: Problem, seed: int) -> np.ndarray:
    """Values of the variables; the best of up to ATTEMPTS."""
    best, least = None, np.inf
    for attempt in range(ATTEMPTS):
        found = fit_small(problem, seed + 100 * attempt, EFFORT)
        values, error = polish(problem, found.values, POLISH_EVALUATIONS)
        if best is None or error < least:
            best, least = values, error
        if least <= EXPLAINED or whiteness(problem.residuals(best)).is_white:
            break
    assert best is not None
    return best


def errors_pct(problem: Problem, values: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Relative to the truth, in the order of elements that is nearest to it."""
    best = np.full(len(truth), np.inf)
    for order in orders_of(problem):
        errors = 100.0 * np.abs(values[order] / truth - 1.0)
        if np.median(errors) < np.median(best):
            best = errors
    return best


def orders_of(problem: Problem) -> list[np.ndarray]:
    """Orders of the variables that describe the same damper: of a network, its elements' in any
    sequence."""
    plain = np.arange(len(problem.variables))
    if not problem.model.name.startswith(NETWORK):
        return [plain]
    slots: dict[str, list[int]] = {}
    for k, one in enumerate(problem.variables):
        numbered = re.fullmatch(r"([a-z]+)([1-9])(_.*)?", one.name)
        if numbered:
            slots.setdefault(numbered[1], []).append(k)
    count = max(len(some) for some in slots.values())
    out = []
    for sequence in permutations(range(count)):
        order = plain.copy()
        for some in slots.values():
            order[some] = np.array(some)[list(sequence)]
        out.append(order)
    return out


def coverage(truth: Truth, values: np.ndarray, seeds: int) -> np.ndarray:
    """Part of the noise seeds whose 95 % interval holds the truth, [variables]."""
    held = np.zeros(len(values))
    for seed in range(seeds):
        problem = truth.problem(NOISE_PART, seed)
        found, _error = polish(problem, values, SEED_EVALUATIONS)
        for k, one in enumerate(intervals(problem, found)):
            held[k] += one.low <= values[k] <= one.high
    return held / max(1, seeds)


def measure(
    size: Size, progress: Progress | None = None, say: Say | None = None
) -> list[ModelResult]:
    results = []
    for name in size.models or measured_models():
        results.append(measure_model(name, size, say or (lambda _text: None)))
        if progress is not None:
            progress.done(f"{name}: truth, fits and intervals")
    return results


def measured_models() -> tuple[str, ...]:
    """Every kernel, but for those that have to be told a geometry: papers' parts have those."""
    return tuple(name for name, one in library.models().items() if not one.told)


def percentage(flags: Sequence[bool]) -> float | None:
    return 100.0 * float(np.mean(flags)) if flags else None


def figures_of(results: Sequence[ModelResult], c3_pct: float) -> list[Figure]:
    all_of = [one for result in results for one in result.parameters]
    determined = [one.exact_error_pct <= EXACT_GOAL_pct for one in all_of if one.is_determined]
    judged = [one.noisy_error_pct <= NOISY_GOAL_pct for one in all_of if one.is_judged]
    covered = [one.coverage_pct for one in all_of if one.coverage_pct is not None]
    by_model = [one.coverage_pct for one in results if one.coverage_pct is not None]
    low_pct, high_pct = COVERAGE_GOAL_pct
    return [
        Figure("truth_recovered_pct", percentage(determined), "%", 100.0, "higher"),
        Figure("truth_noisy_recovered_pct", percentage(judged), "%", 100.0, "higher"),
        Figure("truth_coverage_pct", float(np.mean(covered)), "%", None, "higher"),
        Figure("truth_coverage_least_model_pct", min(by_model), "%", low_pct, "higher"),
        Figure("truth_coverage_most_model_pct", max(by_model), "%", high_pct, "lower"),
        Figure("truth_parameters", float(len(all_of)), "1", None, "higher"),
        Figure("truth_parameters_determined", float(len(determined)), "1", None, "higher"),
        Figure("truth_parameters_judged", float(len(judged)), "1", None, "higher"),
        Figure("truth_least_squares_worst_pct", c3_pct, "%", 1.0, "lower"),
    ]


def table(result: ModelResult) -> str:
    rows = [
        [
            one.name,
            one.unit,
            f"{one.truth:.5g}",
            f"{one.deviation_pct:.2g}",
            f"{one.exact_error_pct:.2g}",
            f"{one.noisy_error_pct:.2g}",
            "" if one.coverage_pct is None else f"{one.coverage_pct:.0f}",
            verdict(one),
        ]
        for one in result.parameters
    ]
    head = ["", "unit", "truth", "Cramer-Rao %", "no noise %", "noise %", "covered %", ""]
    title = f"{result.name}: {result.evaluations} simulations without noise"
    return f"{title}\n{format_table(head, rows, left=(0, 1, 7))}"


def verdict(one: ParameterResult) -> str:
    if not one.is_determined:
        return "not determined by these tests"
    if one.exact_error_pct > EXACT_GOAL_pct:
        return "MISSED"
    if one.is_judged and one.noisy_error_pct > NOISY_GOAL_pct:
        return "MISSED with noise"
    return ""


def summary(results: Sequence[ModelResult]) -> str:
    """What was missed, and what could not be determined."""
    lines = [
        f"{result.name} {one.name}: {verdict(one)} (Cramer-Rao {one.deviation_pct:.2g} %, "
        f"without noise {one.exact_error_pct:.2g} %, with noise {one.noisy_error_pct:.2g} %)"
        for result in results
        for one in result.parameters
        if verdict(one)
    ]
    return "\n".join(["parameters that were missed or are not determined:", *(lines or ["none"])])


def tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def figures(quick: bool, folder: Path) -> tuple[list[Figure], list[str]]:
    """Figures and tables. Nothing is written into the folder."""
    del folder
    size = QUICK if quick else FULL
    results = measure(size, Progress(len(size.models or measured_models())), tell)
    c3_text, c3_pct = truth_c3.table(3 if quick else 9)
    return figures_of(results, c3_pct), [*map(table, results), summary(results), c3_text]
