"""A problem seen by its nonlinear variables only, with as few simulations as that takes.

For given nonlinear variables the force is a base plus amounts (the linear variables) of columns.
Many columns, such as that of the viscous damping, are the same whatever the nonlinear variables
are: those are recognised on the first candidates and not simulated again. That is a conclusion
from examples; `check` compares with a full simulation.
"""

import numpy as np

from quiesce.damper.fit.problem import Problem

# Columns of candidates with other nonlinear variables that agree to this are the same for all.
_SAME = 1e-12
# Part of the error by which `check` may find a full simulation to differ.
_AGREES = 1e-3


class Projected:
    """Columns are numbered as Problem.linear; number 0 here is the base, the others follow."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        linear = [problem.variables[k] for k in problem.linear]
        self._sizes = np.array([one.natural for one in linear])
        self._known: dict[int, np.ndarray] = {}
        self._is_learned = False

    def solve(self, parts: np.ndarray, finest: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Values of all variables [candidates, variables] and residuals (model - measured) /
        ||measured|| [candidates, samples]; not finite where a candidate diverges."""
        values = self.problem.values_from(parts)
        with np.errstate(all="ignore"):
            columns = self._columns(values, finest)
            return values, self.problem.solve_linear(values, columns)

    def check(self, values: np.ndarray) -> bool:
        """Whether a full simulation has the error that the columns say; else all columns are
        simulated from now on."""
        parts = self.problem.parts_of(values[None, :])
        said = float(np.linalg.norm(self.solve(parts)[1][0]))
        is_same = abs(self.problem.error(values) - said) <= _AGREES * said + _SAME
        if not is_same:
            self._known = {}
        return is_same

    def _columns(self, values: np.ndarray, finest: int) -> np.ndarray:
        """Base and columns, [candidates, 1 + linear, samples]."""
        count = 1 + len(self.problem.linear)
        first = 0
        learned: np.ndarray | None = None
        if not self._is_learned:
            first = min(2, len(values))
            learned = self._simulated(values[:first], list(range(count)), finest)
            if first == 2:
                self._learn(learned)
            if first == len(values):
                return learned
        rest = values[first:]
        unknown = [k for k in range(count) if k not in self._known]
        out = np.empty((len(rest), count, len(self.problem.target)))
        for k, column in self._known.items():
            out[:, k] = column
        if unknown:
            out[:, unknown] = self._simulated(rest, unknown, finest)
        return out if learned is None else np.concatenate([learned, out])

    def _simulated(self, values: np.ndarray, numbers: list[int], finest: int) -> np.ndarray:
        """These columns, [candidates, numbers, samples]; the base is simulated where it is not
        known."""
        is_base_needed = 0 not in self._known
        wanted = [0, *(k for k in numbers if k)] if is_base_needed else numbers
        unit = np.repeat(values[:, None, :], len(wanted), axis=1)
        for j, k in enumerate(wanted):
            if k:
                unit[:, j, self.problem.linear[k - 1]] = self._sizes[k - 1]
        found = self.problem.outputs(unit.reshape(-1, values.shape[1]), finest)
        found = found.reshape(len(values), len(wanted), -1)
        base = found[:, :1] if is_base_needed else self._known[0][None, None, :]
        columns = found[:, 1:] if is_base_needed else found
        return np.concatenate([base, columns - base], axis=1) if 0 in numbers else columns - base

    def _learn(self, columns: np.ndarray) -> None:
        """columns of two candidates, [2, 1 + linear, samples]."""
        self._is_learned = True
        for k in range(columns.shape[1]):
            first, second = columns[:, k]
            size = np.max(np.abs(columns)) if k == 0 else np.max(np.abs(first))
            if np.max(np.abs(first - second)) <= _SAME * size:
                self._known[k] = first
