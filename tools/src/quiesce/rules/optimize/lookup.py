"""Constant currents swept over steady states: the paper's Table VII, and what no rule can beat.

In a steady state a rule base that has settled gives one current. The best constant current is then
the best that any static table of rules can do there.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

from quiesce.base.progress import Progress
from quiesce.base.table import format_table
from quiesce.rules.optimize.evaluate import ClosedLoop, Place
from quiesce.rules.optimize.objective import Objective, Outcome, Steady


@dataclass(frozen=True)
class Sweep:
    """Every place at every constant current."""

    places: Sequence[Place]
    current_mA: Sequence[int]
    outcomes: Sequence[Outcome]  # [current][place]

    def best(self, place: int, cost: Callable[[Steady], float]) -> tuple[int, Steady]:
        """The current of least cost at a place, the smallest of equals, and what it achieves."""
        costs = [cost(outcome[place]) for outcome in self.outcomes]
        index = costs.index(min(costs))
        return self.current_mA[index], self.outcomes[index][place]


def grid_mA(top_mA: int, step_mA: int) -> list[int]:
    return [*range(0, top_mA, step_mA), top_mA]


def sweep(loop: ClosedLoop, top_mA: int, step_mA: int, pool: Executor) -> Sweep:
    currents = grid_mA(top_mA, step_mA)
    progress = Progress(len(currents))

    def measure(current_mA: int) -> Outcome:
        outcome = loop.of_constant(current_mA)
        progress.done(f"constant {current_mA / 1000:g} A, {len(outcome)} steady states")
        return outcome

    futures = [pool.submit(measure, current_mA) for current_mA in currents]
    return Sweep(loop.places, currents, [future.result() for future in futures])


def accel_left(steady: Steady) -> float:
    return -steady.accel_rms_reduction_pct


def amp_left(steady: Steady) -> float:
    return -steady.amp_reduction_pct


def best_constants(found: Sweep, objective: Objective) -> list[tuple[int, Steady]]:
    """Of every place, by the search's own objective."""
    return [
        found.best(i, lambda steady: objective.cost([steady])) for i in range(len(found.places))
    ]


def lookup_table(found: Sweep) -> str:
    """Table VII: the current of least RMS acceleration by frequency and drive."""
    head = [
        "frequency Hz||g", "drive V||g", "at 0 A: um||.1f", "mm/s2||.1f", "current A||g",
        "acceleration %||z.1f", "displacement %||z.1f", "for displacement A||g",
        "displacement %||z.1f",
    ]  # fmt: skip
    rows = []
    for i, place in enumerate(found.places):
        current_mA, best = found.best(i, accel_left)
        amp_mA, amp_best = found.best(i, amp_left)
        rows.append([
            place.freq_Hz, place.drive_V, place.amp_um, place.accel_rms_mm_s2, current_mA / 1000,
            best.accel_rms_reduction_pct, best.amp_reduction_pct, amp_mA / 1000,
            amp_best.amp_reduction_pct,
        ])  # fmt: skip
    return format_table(head, rows, left=())


def lookup_json(found: Sweep) -> list[dict[str, float]]:
    entries = []
    for i, place in enumerate(found.places):
        current_mA, best = found.best(i, accel_left)
        entries.append(
            {
                "freq_hz": place.freq_Hz,
                "drive_V": place.drive_V,
                "current_mA": current_mA,
                "accel_rms_reduction_pct": best.accel_rms_reduction_pct,
                "amp_reduction_pct": best.amp_reduction_pct,
            }
        )
    return entries
