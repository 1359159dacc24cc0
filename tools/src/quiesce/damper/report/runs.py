"""A fitted model run along the scored tests: what plots, spectra and whiteness are made of."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.split import Segment
from quiesce.damper.fit.intervals import Whiteness, whiteness
from quiesce.damper.score import Simulate


@dataclass(frozen=True)
class Run:
    """Scored rows of one test; arrays [n]."""

    segment: Segment
    is_test: bool
    model_N: np.ndarray

    @property
    def measured_N(self) -> np.ndarray:
        return self.segment.record.force_N[self.segment.rows]

    @property
    def residual_N(self) -> np.ndarray:
        return self.measured_N - self.model_N

    @property
    def time_s(self) -> np.ndarray:
        return self.segment.record.time_s[self.segment.rows]

    @property
    def rate_Hz(self) -> float:
        return self.segment.record.rate_Hz

    @property
    def is_finite(self) -> bool:
        return bool(np.isfinite(self.model_N).all())

    @property
    def error(self) -> float:
        """||F - F_model|| / ||F||."""
        size = float(np.linalg.norm(self.measured_N))
        return float(np.linalg.norm(self.residual_N)) / max(size, 1e-300)

    @property
    def label(self) -> str:
        return level_label(self.segment)


def command_parts(run: Run, most: int = 8) -> list[tuple[str, np.ndarray]]:
    """Label and rows (mask) of each command in a test: one where it is constant; where it is
    switched those at each of its levels, or in `most` / 2 bands where it has too many."""
    if run.segment.record.level is not None:
        return [(run.label, np.ones(len(run.model_N), dtype=bool))]
    command = run.segment.record.command[run.segment.rows]
    unit = run.segment.record.command_unit
    places = np.round(command, 1 if np.ptp(command) > 1.0 else 2) + 0.0
    levels, counts = np.unique(places, return_counts=True)
    levels = levels[counts > 0.02 * len(command)]
    if 0 < len(levels) <= most:
        return [(f"{level:g} {unit}", places == level) for level in levels]
    edges = np.linspace(command.min(), command.max(), most // 2 + 1)
    edges[-1] = np.inf
    return [
        (f"{low:.2g} .. {low + edges[1] - edges[0]:.2g} {unit}", (command >= low) & (command < end))
        for low, end in zip(edges[:-1], edges[1:], strict=True)
    ]


def shortened(name: str, most: int = 48) -> str:
    return name if len(name) <= most else "..." + name[3 - most :]


def level_label(segment: Segment) -> str:
    """The command of a test in words: "0.5 A", or "switched"."""
    level = segment.record.level
    if level is None:
        return "switched"
    # Commands are known to a hundredth at best.
    return f"{abs(round(level, 2)):g} {segment.record.command_unit}"


def runs_of(simulate: Simulate, train: Sequence[Segment], test: Sequence[Segment]) -> list[Run]:
    """The model runs from the first row of every record, free; records are simulated once."""
    forces: dict[int, np.ndarray] = {}
    out = []
    for segments, is_test in ((train, False), (test, True)):
        for segment in segments:
            record = segment.record
            if id(record) not in forces:
                forces[id(record)] = record.averaged(simulate(record))
            out.append(Run(segment, is_test, forces[id(record)][segment.rows]))
    return out


def shown_part(runs: Sequence[Run]) -> list[Run]:
    """Held-out runs where there are any, else those that were fitted."""
    return [one for one in runs if one.is_test] or list(runs)


def one_a_level(runs: Sequence[Run], most: int = 6) -> list[Run]:
    """For every command the test with the largest force, at most `most` of them, spread evenly."""
    best: dict[str, Run] = {}
    for one in runs:
        size = float(np.ptp(one.measured_N))
        if one.label not in best or size > float(np.ptp(best[one.label].measured_N)):
            best[one.label] = one
    found = sorted(best.values(), key=lambda one: one.segment.record.level or 0.0)
    if len(found) <= most:
        return found
    return [found[k] for k in np.unique(np.linspace(0, len(found) - 1, most).round().astype(int))]


def whiteness_of(runs: Sequence[Run]) -> Whiteness | None:
    """Of the longest run's residual; None where the model diverges."""
    finite = [one for one in runs if one.is_finite and len(one.model_N) > 8]
    if not finite:
        return None
    return whiteness(max(finite, key=lambda one: len(one.model_N)).residual_N)


def cycle_energies_J(run: Run) -> tuple[float, float]:
    """Energy that the damper takes in a cycle of the motion: measured, model. A cycle lies between
    two upward crossings of the displacement's mean; with less than one, over the whole test."""
    record = run.segment.record.rows(run.segment.first, run.segment.end)
    centred = record.disp_m - record.disp_m.mean()
    ups = np.flatnonzero((centred[:-1] < 0.0) & (centred[1:] >= 0.0))
    part = slice(int(ups[0]), int(ups[-1]) + 1) if len(ups) > 1 else slice(None)
    cycles = max(1, len(ups) - 1)
    speed = record.velocity_m_s[part]
    return (
        float(np.sum(run.measured_N[part] * speed)) / record.rate_Hz / cycles,
        float(np.sum(run.model_N[part] * speed)) / record.rate_Hz / cycles,
    )
