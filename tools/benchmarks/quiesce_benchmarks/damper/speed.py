"""How fast the library evaluates damper models, against scipy and against its own scalar code.

A normalised Bouc-Wen (7 parameters) over 2000 samples of a band-limited random motion: 24 sines of
0.3 .. 5 Hz with random phases and equal speeds, 5 mm RMS, 500 samples/s. The motion between samples
is the same cubic for all contenders. Substeps are the fewest with which every candidate is within
MOST_ERROR of a run with CONVERGED times as many. Times are the thread's own processor time, so that
other programs on the machine do not count; contenders take turns, the best turn of each counts.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from quiesce.base.progress import Progress
from quiesce.base.table import format_table
from quiesce.damper import library
from quiesce.damper.data.record import Record

from quiesce_benchmarks.damper.rk45 import ATOL, RTOL, rk45_force, spline_speed, tuned_speed
from quiesce_benchmarks.damper.synthetic import random_tones, record_of, row_of
from quiesce_benchmarks.report import Figure

MODEL = "normalised_bouc_wen"
SAMPLES = 2000
RATE_Hz = 500.0
BAND_Hz = (0.3, 5.0)
AMPLITUDE_m = 0.01  # twice the RMS
MOST_ERROR = 1e-4
CONVERGED = 128
MOST_SUBSTEPS = 64
SPEEDUP_GOAL = 3000.0
SCALAR_GOAL = 2.0
ORDERS = [1] * 7
# Ranges of the candidates, in the order of the model's parameters (SI units).
LOW = np.array([200.0, 0.0, 200.0, 500.0, 0.6, 1.2, -50.0])
HIGH = np.array([2000.0, 5000.0, 2000.0, 1500.0, 1.2, 2.5, 50.0])


@dataclass(frozen=True)
class Size:
    batch: int  # candidates at once
    scalar_batch: int
    references: int  # candidates that scipy integrates
    turns: int


FULL = Size(1024, 32, 12, 8)
QUICK = Size(256, 8, 3, 3)


@dataclass(frozen=True)
class Contender:
    """One way to evaluate. Errors relative to a converged run, ||F - F_converged|| / ||F||."""

    name: str
    candidate_us: float
    median_error: float
    worst_error: float


@dataclass(frozen=True)
class Speeds:
    substeps: int
    rk45: Contender  # scipy, its own spline
    rk45_tuned: Contender  # scipy, the motion from a table
    sets: Sequence[Contender]  # fastest first, one thread
    two_threads_us: float  # per candidate, wall time
    evaluations: float  # of the rate, for a candidate of scipy's

    @property
    def fastest(self) -> Contender:
        return min(self.sets, key=lambda one: one.candidate_us)

    @property
    def scalar(self) -> Contender:
        return next(one for one in self.sets if one.name == "scalar")


def test_record(seed: int = 1) -> Record:
    return record_of(random_tones(seed, BAND_Hz, AMPLITUDE_m), RATE_Hz, SAMPLES)


def random_rows(count: int, seed: int) -> np.ndarray:
    """Candidates of the library, [count, row]: each parameter even in LOW .. HIGH."""
    one = library.model(MODEL)
    parts = np.random.default_rng(seed).random((count, len(LOW)))
    return np.array([row_of(one, values) for values in LOW + (HIGH - LOW) * parts])


def simulate(rows: np.ndarray, record: Record, substeps: int, instructions: str = "") -> np.ndarray:
    one = library.model(MODEL)
    return library.simulate(one, ORDERS, rows, library.motion(record), substeps, instructions)


def relative_errors(force_N: np.ndarray, exact_N: np.ndarray) -> np.ndarray:
    return np.linalg.norm(force_N - exact_N, axis=1) / np.linalg.norm(exact_N, axis=1)


def fewest_substeps(rows: np.ndarray, record: Record, exact_N: np.ndarray) -> int:
    """With which every row is within MOST_ERROR."""
    for substeps in range(1, MOST_SUBSTEPS):
        errors = relative_errors(simulate(rows, record, substeps), exact_N)
        if np.max(errors) <= MOST_ERROR:
            return substeps
    return MOST_SUBSTEPS


def own_time_s(work: Callable[[], object]) -> float:
    """Processor time of this thread."""
    start_s = time.thread_time()
    work()
    return time.thread_time() - start_s


def measure(size: Size, seed: int = 1, progress: Progress | None = None) -> Speeds:
    record = test_record(seed)
    rows = random_rows(size.batch, seed)
    exact_N = simulate(rows, record, CONVERGED)
    substeps = fewest_substeps(rows, record, exact_N)
    sets = library.module().instruction_sets()
    work = {name: batch_work(rows, record, substeps, name, size) for name in sets}
    speeds = {"spline": spline_speed(record), "table": tuned_speed(record)}
    found = rk45_runs(rows[: size.references], record, speeds)
    best: dict[str, float] = {}
    for turn in range(size.turns):
        for name, (count, run) in work.items():
            spent_us = 1e6 * own_time_s(run) / count
            best[name] = min(best.get(name, np.inf), spent_us)
        for name, speed in speeds.items():
            row = turn % size.references
            for k in (row, (row + size.references // 2) % size.references):
                spent_us = 1e6 * own_time_s(lambda k=k, s=speed: rk45_force(rows[k], record, s))
                key = f"{name} {k}"
                best[key] = min(best.get(key, np.inf), spent_us)
        if progress is not None:
            progress.done(f"evaluation speed, turn {turn + 1}")
    reference_N = exact_N[: size.references]
    return Speeds(
        substeps,
        rk45_contender("spline", best, found["spline"][0], reference_N),
        rk45_contender("table", best, found["table"][0], reference_N),
        [set_contender(name, best[name], rows, record, substeps, exact_N) for name in sets],
        two_threads_us(rows, record, substeps, size.turns),
        float(np.mean(found["spline"][1])),
    )


def batch_work(
    rows: np.ndarray, record: Record, substeps: int, name: str, size: Size
) -> tuple[int, Callable[[], object]]:
    """How many candidates, and their squared errors by one set of instructions."""
    count = size.scalar_batch if name == "scalar" else len(rows)
    one, motion = library.model(MODEL), library.motion(record)
    zero, ones = np.zeros(SAMPLES), np.ones(SAMPLES)

    def run() -> object:
        return library.squared_error(
            one, ORDERS, rows[:count], motion, substeps, zero, ones, 1, name
        )

    return count, run


def rk45_runs(
    rows: np.ndarray, record: Record, speeds: Mapping[str, Callable[[float], float]]
) -> dict[str, tuple[np.ndarray, list[int]]]:
    """Forces and evaluations of each row, by the way the motion is looked up."""
    out = {}
    for name, speed in speeds.items():
        runs = [rk45_force(row, record, speed) for row in rows]
        out[name] = (np.array([force for force, _ in runs]), [count for _, count in runs])
    return out


def rk45_contender(
    name: str, best: Mapping[str, float], force_N: np.ndarray, exact_N: np.ndarray
) -> Contender:
    """Time: the median of the candidates that had their turn, each at its best."""
    times_us = [value for key, value in best.items() if key.startswith(f"{name} ")]
    errors = relative_errors(force_N, exact_N)
    return Contender(
        f"scipy RK45, {name}",
        float(np.median(times_us)),
        float(np.median(errors)),
        float(np.max(errors)),
    )


def set_contender(
    name: str,
    candidate_us: float,
    rows: np.ndarray,
    record: Record,
    substeps: int,
    exact_N: np.ndarray,
) -> Contender:
    count = min(len(rows), 64)
    errors = relative_errors(simulate(rows[:count], record, substeps, name), exact_N[:count])
    return Contender(name, candidate_us, float(np.median(errors)), float(np.max(errors)))


def two_threads_us(rows: np.ndarray, record: Record, substeps: int, turns: int) -> float:
    """Wall time per candidate of two threads that share the batch."""
    halves = np.array_split(rows, 2)
    best_us = np.inf
    with ThreadPoolExecutor(2) as pool:
        for _ in range(turns):
            start_s = time.perf_counter()
            list(pool.map(lambda half: simulate(half, record, substeps), halves))
            best_us = min(best_us, 1e6 * (time.perf_counter() - start_s) / len(rows))
    return best_us


def table(found: Speeds) -> str:
    fastest = found.fastest
    rows = [
        [
            one.name,
            f"{one.candidate_us:.1f}",
            f"{one.candidate_us / fastest.candidate_us:.1f}",
            f"{one.median_error:.1e}",
            f"{one.worst_error:.1e}",
        ]
        for one in (found.rk45, found.rk45_tuned, *found.sets)
    ]
    head = ["evaluator", "us a candidate", "over the fastest", "median error", "worst"]
    return "\n".join(
        [
            f"{MODEL}, {SAMPLES} samples at {RATE_Hz:g} Hz of a random motion of "
            f"{BAND_Hz[0]:g} .. {BAND_Hz[1]:g} Hz; {found.substeps} steps a sample, scipy rtol "
            f"{RTOL:g}, atol {ATOL:g}, {found.evaluations:.0f} evaluations of the rate;",
            "processor time of one thread; errors against a converged run. 'spline': scipy's "
            "CubicHermiteSpline, 'table': the same cubic in plain Python.",
            format_table(head, rows),
            f"two threads: {found.two_threads_us:.1f} us a candidate (wall time)",
        ]
    )


def figures_of(found: Speeds) -> list[Figure]:
    fastest = found.fastest
    return [
        Figure(
            "batch_speedup_vs_rk45",
            found.rk45.candidate_us / fastest.candidate_us,
            "1",
            SPEEDUP_GOAL,
            "higher",
        ),
        Figure(
            "batch_speedup_vs_rk45_tuned",
            found.rk45_tuned.candidate_us / fastest.candidate_us,
            "1",
            None,
            "higher",
        ),
        Figure(
            "batch_speedup_vs_scalar",
            found.scalar.candidate_us / fastest.candidate_us,
            "1",
            SCALAR_GOAL,
            "higher",
        ),
        Figure("batch_error_worst", fastest.worst_error, "1", MOST_ERROR, "lower"),
        Figure("rk45_error_median", found.rk45.median_error, "1", MOST_ERROR, "lower"),
        Figure("batch_candidate_us", fastest.candidate_us, "us", None, "lower"),
        Figure("batch_two_threads_us", found.two_threads_us, "us", None, "lower"),
    ]


def figures(quick: bool, folder: Path) -> tuple[list[Figure], list[str]]:
    """Figures and tables. Nothing is written into the folder."""
    del folder
    size = QUICK if quick else FULL
    found = measure(size, progress=Progress(size.turns))
    return figures_of(found), [table(found)]
