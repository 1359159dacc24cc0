"""The labelled rule bases, and how they are judged: each in closed loop on its own rig."""

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from quiesce.base.paths import default_plant, root
from quiesce.engine.bench import Bench
from quiesce.rules.formats.files import read_rules
from quiesce.rules.model import RuleBase
from quiesce.rules.optimize.evaluate import ClosedLoop, Place
from quiesce.rules.optimize.objective import OBJECTIVES, Objective, Outcome, Steady
from quiesce.rules.optimize.scenarios import steady_scenarios

FOLDER = root() / "sim_hil/data/rules"
SHIPPED = root() / "firmware/plants/squeeze_2012/rules.fcl"
PUBLISHED = FOLDER / "squeeze_2012_published.fcl"
LEVELLED = FOLDER / "isolated_machine.fcl"
FROZEN = FOLDER / "isolated_machine_frozen.fcl"
RMS = 1  # input of a rule base for the controller; 0 is the frequency


@dataclass(frozen=True)
class Rig:
    """Steady states of one plant: every frequency at every drive."""

    plant: Path
    freqs_Hz: tuple[float, ...]
    drives_V: tuple[float, ...]
    settle_s: int
    max_current_A: float
    settings: tuple[str, ...] = ()


# The published cases.
CANTILEVER = Rig(default_plant(), (5.0, 10.0, 15.0, 20.0), (0.09, 0.10, 0.12), 6, 5.0)
# At which no current is right at all drives: 12 Hz.
LEVELS = Rig(
    root() / "sim_hil/data/plants/isolated_machine.toml", (12.0,), (0.2, 0.6, 0.9, 1.5), 4, 2.0,
)  # fmt: skip
CONSTANTS_A = (0.3, 0.7, 1.2, 2.0)
# Searched at 0.3, 0.9 and 1.5 V: judged between these levels and below them.
MACHINE = Rig(
    root() / "sim_hil/data/plants/isolated_machine.toml",
    (9.0, 12.0, 15.0), (0.2, 0.45, 0.6, 0.75, 1.05, 1.2, 1.35), 4, 2.0, ("unlock_current_mA=0",),
)  # fmt: skip


@dataclass(frozen=True)
class Judged:
    """What one rule base does at every place of a rig."""

    places: Sequence[Place]
    steady: Sequence[Steady]
    cost_pct: float  # mean of what displacement and acceleration are left, of those at 0 A


def judge(bench: Bench, rig: Rig, bases: Sequence[RuleBase], seed: int) -> list[Judged]:
    with closed_loop(bench, rig, seed) as loop:
        return [judged(rig, loop, loop.of_rules(base)) for base in bases]


def judge_constants(bench: Bench, rig: Rig, currents_A: Sequence[float], seed: int) -> list[Judged]:
    """What one current does, whatever moves."""
    with closed_loop(bench, rig, seed) as loop:
        return [judged(rig, loop, loop.of_constant(round(1000.0 * one))) for one in currents_A]


@contextmanager
def closed_loop(bench: Bench, rig: Rig, seed: int) -> Iterator[ClosedLoop]:
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        scenarios = steady_scenarios(
            bench, Path(folder), rig.plant, rig.freqs_Hz, rig.drives_V, rig.settle_s
        )
        yield ClosedLoop(bench, scenarios, rig.settings, ("--seed", str(seed)))


def judged(rig: Rig, loop: ClosedLoop, found: Outcome) -> Judged:
    objective = Objective(OBJECTIVES["balanced"], rig.max_current_A)
    return Judged(loop.places, found, objective.cost(found))


def held_at(base: RuleBase, column: int) -> RuleBase:
    """The same rules with the RMS input held at the top of one of its sets: those of its column,
    whatever the RMS is."""
    rules = tuple(
        replace(rule, conditions=tuple(c for c in rule.conditions if c.input != RMS))
        for rule in base.rules
        if any((c.input, c.set) == (RMS, column) for c in rule.conditions)
    )
    return replace(base, rules=rules)


def frozen_bases(base: RuleBase) -> dict[str, RuleBase]:
    """All that stand for `base` without its RMS input: the one searched so, and its columns."""
    held = {one.name: held_at(base, i) for i, one in enumerate(base.inputs[RMS].sets)}
    return {"searched": read_rules(FROZEN)} | {f"held at {k}": v for k, v in held.items()}
