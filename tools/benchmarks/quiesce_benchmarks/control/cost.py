"""What the law costs on the emulated Cortex-M4, and that the image answers like the host."""

import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from quiesce.engine.bench import target_options

from quiesce_benchmarks.control.rig import BALANCED, SETTINGS, Control, Rig
from quiesce_benchmarks.control.scenarios import Scenario, steady, step

TARGET = "mps2"
FUZZY = Control("fuzzy")
SEEDS = (1, 2)


def scenarios(is_quick: bool) -> list[Scenario]:
    """Where the worst tick is looked for: locking on, adapting, losing the lock, finding it."""
    steps = [step(10.0, 20.0, 8.0), step(5.0, 10.0, 8.0)]
    return steps if is_quick else [*steps, *(steady(f, 20.0) for f in (4.0, 5.0, 11.5, 22.0))]


@dataclass(frozen=True)
class Counted:
    """Instructions of a tick in one scenario."""

    scenario: str
    law: str
    setting: str
    worst_instr: int
    median_instr: int
    ticks: int
    mismatches: int  # words of replies that differ from the host's

    def row(self) -> dict[str, Any]:
        return asdict(self)


def count(rig: Rig, scenario: Scenario, control: Control, setting: str) -> Counted:
    """Every word of every reply compared with the host's on the way."""
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        options = rig.options(scenario, control, rig.plant, Path(folder))
        found = rig.bench.json(
            "compare", *options, "--seeds", ",".join(map(str, SEEDS)), *target_options(TARGET)
        )
    return Counted(
        scenario.name, control.law, setting,
        found["instr_worst"], found["instr_median"], found["ticks"], found["mismatches"],
    )  # fmt: skip


def cases(rig: Rig, is_quick: bool) -> list[tuple[Scenario, Control, str]]:
    """The fuzzy law, and the judged one in each setting."""
    settings: Sequence[str] = SETTINGS if rig.judged.adapts else (BALANCED,)
    laws = [(FUZZY, "-"), *((rig.judged.control(name), name) for name in settings)]
    return [(scenario, *law) for scenario in scenarios(is_quick) for law in laws]


def added_worst_instr(counted: Sequence[Counted], law: str) -> int:
    """Worst tick of the law over that of the fuzzy law, each over the same scenarios."""
    worst = {
        name: max(one.worst_instr for one in counted if one.law == name) for name in (law, "fuzzy")
    }
    return worst[law] - worst["fuzzy"]
