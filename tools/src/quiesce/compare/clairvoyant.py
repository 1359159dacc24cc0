"""The clairvoyant optimum beside a comparison: for each record the best waveform of the currents
that a search finds when it knows the whole record, without noise or delay. No proof of the best."""

import hashlib
import json
import tomllib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from quiesce.base.errors import UsageError
from quiesce.base.paths import cache_folder
from quiesce.base.progress import say
from quiesce.compare.figures import Contact, Figures, figures_of
from quiesce.compare.goal import Goal
from quiesce.compare.records import Record
from quiesce.compare.smooth import Layout
from quiesce.engine.board import Board
from quiesce.engine.trace import Trace
from quiesce.optimum.waveform import Effort, Waveform, best_waveform
from quiesce.plant.library import library_file
from quiesce.plant.open_loop import BaseMotion, Motion, OpenLoop

Floats = NDArray[np.float64]
CLAIRVOYANT = "clairvoyant"
TICK_RATE_Hz = 1000
# Integration steps of a search, as multiples of the plant file's: the longest at which motions
# without and with all current keep their values. What is found is simulated again at its own.
STEP_FACTORS = (8.0, 4.0, 2.0)
SAME = 1e-3
SAID_EVERY = 10  # runs
TO_UM = 1e6


@dataclass(frozen=True)
class Stage:
    """A structure on a record, as the bench would simulate it."""

    plant: Path
    board: Board
    contacts: tuple[Contact, ...]
    record: Record
    time_scale: float
    gain: float
    duration_s: float

    @property
    def ticks(self) -> int:
        return round(self.duration_s * TICK_RATE_Hz)

    def loop(self, step_factor: float = 1.0) -> OpenLoop:
        base = BaseMotion(
            self.record.accel_m_s2, self.record.rate_Hz, self.time_scale, self.gain
        )  # fmt: skip
        return OpenLoop(self.plant, base, self.ticks, TICK_RATE_Hz, step_factor)

    def layout(self, loop: OpenLoop) -> Layout:
        of = loop.places.index
        return Layout(
            tuple(of(name) for name in self.board.bodies),
            tuple((of(one.body), one) for one in self.contacts),
            float(TICK_RATE_Hz),
        )

    def constant_A(self, loop: OpenLoop, current_A: float) -> Floats:
        return np.full((self.ticks, len(loop.dampers)), min(current_A, loop.max_current_A))

    def trace(self, loop: OpenLoop, motion: Motion, command_A: Floats) -> Trace:
        """As the bench writes it: what a comparison's figures read."""
        out: Trace = {"t_s": np.arange(self.ticks) / TICK_RATE_Hz}
        for name in self.board.bodies:
            at = loop.places.index(name)
            out[f"{name}_true_um"] = TO_UM * motion.disp_m[:, at]
            out[f"{name}_true_mm_s2"] = 1e3 * motion.accel_m_s2[:, at]
        for name in self.board.dampers:
            at = loop.dampers.index(name)
            out[f"{name}_true_stroke_um"] = TO_UM * motion.stroke_m[:, at]
            out[f"{name}_true_force_mN"] = 1e3 * motion.force_N[:, at]
            out[f"{name}_true_mA"] = 1e3 * motion.coil_A[:, at]
            out[f"{name}_current_cmd_mA"] = 1e3 * command_A[:, at]
        return out

    def figures(self, loop: OpenLoop, motion: Motion, command_A: Floats) -> Figures:
        trace = self.trace(loop, motion, command_A)
        return figures_of(trace, self.board.bodies, self.board.dampers, self.contacts)

    def commands_of(self, trace: Trace) -> Floats:
        """What a law commanded on the bench, [ticks dampers] in A: it acts one tick later."""
        loop = self.loop()
        out = np.zeros((self.ticks, len(loop.dampers)))
        for name in self.board.dampers:
            own = 1e-3 * trace[f"{name}_current_cmd_mA"]
            out[1:, loop.dampers.index(name)] = own[: self.ticks - 1]
        return np.clip(out, 0.0, loop.max_current_A)


@dataclass(frozen=True)
class Found:
    """The waveform [ticks dampers], and what it does at the plant file's own step, in the driver's
    steps."""

    command_A: Floats
    dampers: tuple[str, ...]
    trace: Trace
    figures: Figures

    def columns(self) -> dict[str, Floats]:
        """t_s, then current_A, of several dampers NAME_current_A."""
        names = [f"{name}_current_A" for name in self.dampers]
        names = ["current_A"] if len(names) == 1 else names
        time_s = np.arange(len(self.command_A)) / TICK_RATE_Hz
        return {"t_s": time_s, **dict(zip(names, self.command_A.T, strict=True))}


@dataclass(frozen=True)
class _Judge:
    stage: Stage
    loop: OpenLoop
    goal: Goal
    all_current: Figures

    def value(self, motion: Motion, command_A: Floats) -> float:
        return self.goal.value(self.stage.figures(self.loop, motion, command_A), self.all_current)

    def smooth(self, motion: Motion, sharpness: float) -> tuple[float, Motion]:
        layout = self.stage.layout(self.loop)
        return self.goal.smooth(motion, layout, self.all_current, sharpness)


def clairvoyant(
    stage: Stage, goal: Goal, all_current: Figures, starts: Sequence[Floats], effort: Effort
) -> Found:
    """From a store on disk where the same was searched for before. starts: commands to descend
    from, beside constant ones."""
    file = cache_folder() / "clairvoyant" / f"{_key(stage, goal, starts, effort)}.npy"
    if file.is_file():
        command_A = np.load(file)
    else:
        command_A = _searched(stage, goal, all_current, starts, effort).command_A
        file.parent.mkdir(parents=True, exist_ok=True)
        staging = file.with_suffix(".part")
        with staging.open("wb") as stream:
            np.save(stream, command_A)
        staging.replace(file)
    return replayed(stage, command_A)


def replayed(stage: Stage, command_A: Floats) -> Found:
    """What a waveform does, as the bench would simulate it."""
    loop = stage.loop()
    motion = loop.run(command_A, is_rounded=True)
    trace = stage.trace(loop, motion, command_A)
    figures = figures_of(trace, stage.board.bodies, stage.board.dampers, stage.contacts)
    return Found(command_A, tuple(loop.dampers), trace, figures)


def _searched(
    stage: Stage, goal: Goal, all_current: Figures, starts: Sequence[Floats], effort: Effort
) -> Waveform:
    ceiling_A = 1e-3 * stage.board.ceiling_mA
    loop = _quick_loop(stage, ceiling_A)
    constants = [stage.constant_A(loop, part * ceiling_A) for part in np.linspace(0.0, 1.0, 9)]
    runs = 0

    def told(best: float) -> None:
        nonlocal runs
        runs += 1
        if runs % SAID_EVERY == 0:
            say(f"{CLAIRVOYANT}, {stage.record.name}: {goal.name} {best:.4f} after {runs} of "
                f"about {effort.runs} runs")  # fmt: skip

    judge = _Judge(stage, loop, goal, all_current)
    return best_waveform(loop, judge, ceiling_A, [*constants, *starts], effort, told)


def _quick_loop(stage: Stage, ceiling_A: float) -> OpenLoop:
    exact = _sizes(stage, stage.loop(), ceiling_A)
    for factor in STEP_FACTORS:
        loop = stage.loop(factor)
        with suppress(UsageError):  # it diverges
            if np.allclose(_sizes(stage, loop, ceiling_A), exact, rtol=SAME, atol=0.0):
                return loop
    return stage.loop()


def _sizes(stage: Stage, loop: OpenLoop, ceiling_A: float) -> Floats:
    motions = [loop.run(stage.constant_A(loop, one)) for one in (0.0, ceiling_A)]
    return np.array([
        measure(part)
        for motion in motions
        for part in (motion.disp_m, motion.accel_m_s2, motion.force_N)
        for measure in (np.std, np.max)
    ])  # fmt: skip


def _key(stage: Stage, goal: Goal, starts: Sequence[Floats], effort: Effort) -> str:
    """Of all that decides what is found, the simulation's code among it."""
    told = hashlib.sha256(library_file().read_bytes())
    for content in _contents(stage.plant):
        told.update(content)
    told.update(stage.record.accel_m_s2.tobytes())
    for start in starts:
        told.update(start.tobytes())
    settings = {
        "rate_Hz": stage.record.rate_Hz, "time_scale": stage.time_scale, "gain": stage.gain,
        "ticks": stage.ticks, "ceiling_mA": stage.board.ceiling_mA, "bodies": stage.board.bodies,
        "goal": goal.weights, "effort": asdict(effort), "steps": STEP_FACTORS,
    }  # fmt: skip
    told.update(json.dumps(settings, sort_keys=True).encode())
    return told.hexdigest()[:32]


def _contents(plant: Path) -> list[bytes]:
    """The plant file, and every file that it or a damper's file names."""
    found: list[bytes] = []
    left = [plant]
    while left:
        file = left.pop()
        found.append(file.read_bytes())
        if file.suffix == ".toml":
            names = _texts(tomllib.loads(found[-1].decode()))
            left += [one for name in names if (one := file.parent / name).is_file()]
    return found


def _texts(data: object) -> list[str]:
    if isinstance(data, dict):
        return [text for value in data.values() for text in _texts(value)]
    if isinstance(data, list):
        return [text for value in data for text in _texts(value)]
    return [data] if isinstance(data, str) else []
