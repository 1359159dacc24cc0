"""Saturated and stuck channels, planted into every measured test, and the untouched tests."""

import numpy as np
from quiesce.base.errors import BenchFailure
from quiesce.base.table import format_table
from quiesce.damper.data.channels import cycles_of, suspicions
from quiesce.damper.data.read import RawTest

from quiesce_benchmarks.damper.benchmark import no_data
from quiesce_benchmarks.damper.real import data_folder
from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.unseen.measured import measured_tests
from quiesce_benchmarks.unseen.planted import NOISE, exported, planted

TITLE = "channels with faults in measured files"
FIGURES = (
    ("saturation_found_pct", "%", 100.0, "higher"),
    ("saturation_false", "1", 0.0, "lower"),
)


def measure(effort: Effort) -> Measured:
    folder = data_folder()
    if folder is None:
        raise BenchFailure(no_data())
    tests = measured_tests(folder)
    counts: dict[str, list[int]] = {}
    false = 0
    missed: list[str] = []
    for test in tests:
        false += len(suspicions(test))
        if "displacement" not in test.si:
            continue
        cycle = cycles_of(test.si["displacement"])
        if cycle is None:
            continue
        rows = float(np.median(cycle))
        false += sum(
            len(suspicions(exported(test, rows, noise, effort.seed))) for noise in (0.0, NOISE)
        )
        missed += plant_all(test, rows, effort.seed, counts)
    found, all_of_them = (sum(values) for values in zip(*counts.values(), strict=True))
    table = format_table(
        ["planted", "told", "of"],
        [[name, str(told), str(of)] for name, (told, of) in counts.items()],
        left=(0,),
    )
    return Measured(
        {"saturation_found_pct": 100.0 * found / all_of_them, "saturation_false": float(false)},
        {"tests": len(tests), "planted": counts, "missed": missed},
        (table,),
    )


def plant_all(test: RawTest, rows: float, seed: int, counts: dict[str, list[int]]) -> list[str]:
    """Adds what was told, and of how many, to `counts`; returns what was not."""
    missed = []
    for one in planted(test, rows, seed):
        is_told = any(one.word in text for text in suspicions(one.test))
        count = counts.setdefault(one.name, [0, 0])
        count[0] += is_told
        count[1] += 1
        if not is_told:
            missed.append(f"{test.name.rsplit('/', 1)[-1]}: {one.name}")
    return missed
