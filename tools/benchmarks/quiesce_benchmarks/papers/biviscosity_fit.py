"""Identification by the squeeze-mode paper's protocol: fitted at one cell, judged on the others."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from quiesce.damper import library
from quiesce.damper.candidates import Choice, parametric_candidates, setting_of
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import whole
from quiesce.damper.fit.intervals import intervals
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import Fit

from quiesce_benchmarks.papers.squeeze_rig import (
    CELLS,
    CURRENTS_A,
    PUBLISHED_N,
    Film,
    Sensors,
    recorded,
    rms,
)

MODEL = "squeeze_biviscosity"
GEOMETRY = ("plate_radius_m", "gap_m", "coil_turns", "coil_radius_m", "force_scale")
# Table III does not say n.
BOUC_WEN = Choice(fixed={"n": 2.0, "f0_N": 0.0}, rig=())

Recordings = dict[tuple[tuple[float, float], float], Record]
Search = Callable[[Problem, int], Fit]


def recordings(film: Film, seed: int, sensors: Sensors) -> Recordings:
    """Every cell at every current."""
    return {
        (cell, current_A): recorded(film, cell, current_A, seed, sensors)
        for cell in CELLS
        for current_A in CURRENTS_A
    }


def film_choice(geometry: Mapping[str, float]) -> Choice:
    """eta, gamma, A_h and b free, nothing of the rig."""
    return Choice(fixed={key: geometry[key] for key in GEOMETRY}, rig=())


def problem_of(records: Sequence[Record], model: str, choice: Choice) -> Problem:
    """Of eq 18: every sample counts the same."""
    segments = [whole(record) for record in records]
    return Problem(setting_of(parametric_candidates()[model], segments, choice), segments, "sample")


def film_problem(film: Film, made: Recordings) -> Problem:
    records = [made[CELLS[0], current_A] for current_A in CURRENTS_A]
    return problem_of(records, MODEL, film_choice(film.parameters))


def rmse_N(problem: Problem, values: np.ndarray, record: Record) -> float:
    row = problem.rows(values)[0]
    force_N = library.simulate_row(problem.model, problem.orders, row, record)
    return rms(force_N - record.force_N)


@dataclass(frozen=True)
class Judged:
    """A film identified: values by name, RMSE in N by current, then cell."""

    values: dict[str, float]
    rmse_N: list[list[float]]

    @property
    def within(self) -> list[int]:
        """By current: cells not fitted whose RMSE is at most that published."""
        return [
            sum(ours <= printed for ours, printed in zip(row[1:], published[1:], strict=True))
            for row, published in zip(self.rmse_N, PUBLISHED_N, strict=True)
        ]


def judged(problem: Problem, found: Fit, made: Recordings) -> Judged:
    names = [one.name for one in problem.variables]
    rows = [
        [rmse_N(problem, found.values, made[cell, current_A]) for cell in CELLS]
        for current_A in CURRENTS_A
    ]
    return Judged(dict(zip(names, map(float, found.values), strict=True)), rows)


def half_widths_pct(film: Film, problem: Problem) -> dict[str, float]:
    """Half of each parameter's 95 % interval, at the truth: from the Jacobian and what the sensors
    leave there."""
    true = np.array([film.parameters[one.name] for one in problem.variables])
    return {one.name: 100.0 * one.relative for one in intervals(problem, true)}


def errors_pct(film: Film, values: Mapping[str, float]) -> dict[str, float]:
    return {
        name: 100.0 * abs(value / film.parameters[name] - 1.0) for name, value in values.items()
    }


def bouc_wen_rmse_N(made: Recordings, search: Search, seed: int) -> list[list[float]]:
    """A Bouc-Wen model a current, fitted at the first cell as in Table III: RMSE in N by current,
    then cell."""
    rows = []
    for current_A in CURRENTS_A:
        problem = problem_of([made[CELLS[0], current_A]], "bouc_wen", BOUC_WEN)
        values = search(problem, seed).values
        rows.append([rmse_N(problem, values, made[cell, current_A]) for cell in CELLS])
    return rows
