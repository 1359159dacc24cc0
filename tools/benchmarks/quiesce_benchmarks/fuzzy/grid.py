"""Accuracy on the reference controller: engines, peers and the exact reference over a grid.

The grid has both ends of both universes. "engine": the reference is fed the same integers, so that
only the engine's arithmetic is left. "end to end": the reference is fed the physical inputs, so
that the rounding of inputs and output is in it, too.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np
from quiesce.base.errors import UsageError, one_line
from quiesce.rules.engine.engine import STRAIGHT, TABLE, Engine
from quiesce.rules.formats.files import write_text
from quiesce.rules.reference import evaluate

from quiesce_benchmarks.fuzzy.peers import Job, fuzzylite, pyfuzzylite
from quiesce_benchmarks.fuzzy.reference import (
    CENTROID,
    MAX,
    METHODS,
    PHYSICAL,
    Q15,
    SINGLETON_METHODS,
    SUM,
    Variant,
    compiled,
    reference_base,
)

ENGINES = (TABLE, STRAIGHT)
RESOLUTIONS = (100, 200)
# Samples of the peers' centroids, beside the engine's own grid.
EXACT = "exact reference"
LIBFUZZYLITE, PYFUZZYLITE = "libfuzzylite 6", "pyfuzzylite 8"


@dataclass(frozen=True)
class Error:
    """Largest difference of two answers over the grid, and where."""

    what: str
    method: str
    format: str  # of the integers; empty: none
    of: str
    against: str
    worst_A: float
    mean_A: float
    at_freq_Hz: float
    at_accel_m_s2: float

    def row(self) -> dict[str, Any]:
        return asdict(self)


@dataclass(frozen=True)
class GridResult:
    side: int
    errors: list[Error]
    absent: list[str]
    maps: dict[str, np.ndarray]  # for plots: [frequency, acceleration], A

    def worst_A(
        self, what: str, methods: Sequence[str], of: str = "", form: str = ""
    ) -> float | None:
        """Largest of the errors of this kind; None where there is none."""
        found = [
            error.worst_A
            for error in self.errors
            if error.what == what
            and error.method in methods
            and of in ("", error.of)
            and form in ("", error.format)
        ]
        return max(found, default=None)


class Grid:
    """side x side points, and what is known about them."""

    def __init__(self, side: int) -> None:
        self.side = side
        inputs = reference_base(SUM).inputs
        self.axes = [np.linspace(v.minimum, v.maximum, side) for v in inputs]
        self.points = np.stack(
            [one.ravel() for one in np.meshgrid(*self.axes, indexing="ij")], axis=1
        )

    @cache  # noqa: B019, one grid a run
    def exact(self, method: str) -> np.ndarray:
        """[point], at the physical inputs."""
        return self._reference(method, self.axes)

    def exact_of_integers(self, variant: Variant) -> np.ndarray:
        """[point], at what the integers stand for."""
        made = compiled(variant)
        axes = [made.input_value(i, made.input_integer(i, x)) for i, x in enumerate(self.axes)]
        return self._reference(variant.method, axes)

    def _reference(self, method: str, axes: Sequence[np.ndarray]) -> np.ndarray:
        open_axes = [axes[0][:, None], axes[1][None, :]]
        return evaluate(reference_base(method), open_axes).outputs[0].ravel()

    def engine(self, variant: Variant, kind: str) -> np.ndarray:
        """[point], in A; no default stands anywhere on this controller."""
        made = compiled(variant)
        integers = [made.input_integer(i, x) for i, x in enumerate(self.points.T)]
        outputs, defaults = Engine(made, kind).evaluate(integers)
        if defaults.any():
            raise AssertionError(f"{variant.name}: a default on a covered universe")
        return made.output_value(0, outputs[0])

    def error(
        self, what: str, variant: Variant | str, of: str, against: str, a: np.ndarray, b: np.ndarray
    ) -> Error:
        off = np.abs(a - b)
        worst = int(off.argmax())
        method, form = (
            (variant, "") if isinstance(variant, str) else (variant.method, variant.format)
        )
        freq_Hz, accel_m_s2 = (float(x) for x in self.points[worst])
        return Error(
            what,
            method,
            form,
            of,
            against,
            float(off[worst]),
            float(off.mean()),
            freq_Hz,
            accel_m_s2,
        )


def engine_errors(grid: Grid, maps: dict[str, np.ndarray]) -> list[Error]:
    found = []
    for variant in (Variant(method, form) for method in METHODS for form in (Q15, PHYSICAL)):
        same, exact = grid.exact_of_integers(variant), grid.exact(variant.method)
        for kind in ENGINES:
            answer = grid.engine(variant, kind)
            found.append(grid.error("engine", variant, kind, EXACT, answer, same))
            found.append(grid.error("end to end", variant, kind, EXACT, answer, exact))
        maps[f"{variant.name}: engine"] = (answer - same).reshape(grid.side, grid.side)
        maps[f"{variant.name}: end to end"] = (answer - exact).reshape(grid.side, grid.side)
    return found


def fuzzylite_errors(grid: Grid, maps: dict[str, np.ndarray]) -> list[Error]:
    """libfuzzylite sums; its centroid at each resolution."""
    text = write_text(reference_base(SUM), "fll")
    summed = fuzzylite(Job(text, grid.points))[:, 0]
    found = peer_errors(grid, SUM, LIBFUZZYLITE, summed)
    maximum = grid.exact(MAX)
    found.append(grid.error("semantics", MAX, LIBFUZZYLITE, "maximum per term", summed, maximum))
    text = write_text(reference_base(CENTROID), "fll")
    for resolution in RESOLUTIONS:
        name = f"{LIBFUZZYLITE}, {resolution} samples"
        sampled = fuzzylite(Job(text, grid.points, resolution))[:, 0]
        found += peer_errors(grid, CENTROID, name, sampled)
        off = sampled - grid.exact(CENTROID)
        maps[f"libfuzzylite, {resolution} samples"] = off.reshape(grid.side, grid.side)
    return found


def pyfuzzylite_errors(grid: Grid, _: dict[str, np.ndarray]) -> list[Error]:
    jobs = [
        Job(write_text(reference_base(method), "fll"), grid.points) for method in SINGLETON_METHODS
    ]
    found = []
    for method, answer in zip(SINGLETON_METHODS, pyfuzzylite(jobs), strict=True):
        if isinstance(answer, str):
            raise UsageError(f"pyfuzzylite refuses the reference controller: {answer}")
        found += peer_errors(grid, method, PYFUZZYLITE, answer[:, 0])
    return found


def peer_errors(grid: Grid, method: str, peer: str, answer: np.ndarray) -> list[Error]:
    """The peer against the exact reference, and the engines end to end against the peer."""
    found = [grid.error("peer", method, peer, EXACT, answer, grid.exact(method))]
    for form in (Q15, PHYSICAL):
        variant = Variant(method, form)
        ours = grid.engine(variant, STRAIGHT)
        found.append(grid.error("end to end", variant, STRAIGHT, peer, ours, answer))
    return found


def measure_grid(side: int, done: Callable[[str], None]) -> GridResult:
    """side: points of each axis. A peer that cannot be had is told in `absent`."""
    grid = Grid(side)
    maps: dict[str, np.ndarray] = {}
    errors = engine_errors(grid, maps)
    done(f"engines over {side} x {side} points")
    absent = []
    for name, measure in ((LIBFUZZYLITE, fuzzylite_errors), (PYFUZZYLITE, pyfuzzylite_errors)):
        try:
            errors += measure(grid, maps)
        except UsageError as error:
            absent.append(f"{name}: {one_line(error)}")
        done(f"{name} over {side} x {side} points")
    return GridResult(side, errors, absent, maps)
