"""What searches by a population of candidates share: all variables within their search ranges, none
projected out."""

import numpy as np

from quiesce.damper.fit.problem import SEARCH_SUBSTEPS, Problem

# Numbers that one evaluation may hold: candidates times samples.
_CHUNK = 4_000_000


def ranges_of(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest value of each variable, [variables] each."""
    low, high = np.array([one.search for one in problem.variables]).T
    return low, high


def values_of(problem: Problem, parts: np.ndarray) -> np.ndarray:
    """Values from search coordinates 0 .. 1, [candidates, variables] each."""
    columns = [one.to_value(part) for one, part in zip(problem.variables, parts.T, strict=True)]
    return np.stack(columns, axis=1)


def errors_of(problem: Problem, values: np.ndarray) -> np.ndarray:
    """||F - F_model|| / ||F|| of [candidates, variables]; infinite where a candidate diverges."""
    samples = sum(len(record) for record in problem.records)
    most = max(1, _CHUNK // samples)
    errors = np.empty(len(values))
    for first in range(0, len(values), most):
        chunk = slice(first, first + most)
        with np.errstate(all="ignore"):
            outputs = problem.outputs(values[chunk], SEARCH_SUBSTEPS)
            errors[chunk] = np.linalg.norm(outputs - problem.target, axis=1) / problem.size
    return np.where(np.isfinite(errors), errors, np.inf)
