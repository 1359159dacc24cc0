"""Records ready to fit, from files and a plan of how to read them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.damper.data.channels import falling_force, suspicions
from quiesce.damper.data.condition import condition_all
from quiesce.damper.data.mapping import Plan, plan_of_mapping, with_low_pass
from quiesce.damper.data.read import RawTest, read_file
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Split


@dataclass(frozen=True)
class Conditioned:
    """Records ready to fit; `notes` say in plain sentences what was found and done, first of all
    the suspicions about channels, which `suspect` has alone."""

    records: list[Record]
    notes: list[str]
    split: Split | None = None
    suspect: tuple[str, ...] = ()


def records_of_set(table: Mapping[str, Any], folder: Path, low_pass_Hz: float) -> Conditioned:
    """Records of one [[set]] of a scoring file, its data below `folder`."""
    where = f"set {table.get('name', '?')}"
    if not isinstance(table.get("file"), str):
        raise UsageError(f"{where}: no file is named")
    plan = with_low_pass(plan_of_mapping(table, where), low_pass_Hz, where)
    return conditioned([folder / table["file"]], plan, None)


def conditioned(files: list[Path], plan: Plan, currents_A: list[float] | None) -> Conditioned:
    """All files read in the same way and conditioned together."""
    if not files:
        raise UsageError("no data: name at least one recording")
    if len({file.resolve() for file in files}) < len(files):
        raise UsageError("one file is named twice; its tests would count double")
    stated = stated_currents(files, plan, currents_A)
    tests: list[RawTest] = []
    notes: list[str] = []
    for file, current_A in zip(files, stated, strict=True):
        raw = read_file(file, replace(plan.columns, current_A=current_A))
        if len(files) > 1 and current_A is None and not {"current", "command"} & set(raw.columns):
            raise UsageError(
                f"{shown(file)}: no column of current or voltage; with several files, state the "
                "current of each: --current-a A,A,..."
            )
        if current_A is not None:
            raw = replace(raw, tests=[with_current(test, current_A) for test in raw.tests])
        tests += raw.tests
        notes += [f"{shown(file)}: {note}" for note in raw.notes]
    records, done = condition_all(tests, plan.settings)
    suspect = suspicions_of(tests, records)
    return Conditioned(records, [*suspect, *notes, *done], plan.split, tuple(suspect))


def suspicions_of(tests: Sequence[RawTest], records: Sequence[Record]) -> list[str]:
    found = [f"suspect: {raw.where}: {text}" for raw in tests for text in suspicions(raw)]
    between = falling_force(records)
    return [*found, *([f"suspect: {between}"] if between else [])]


def with_current(test: RawTest, current_A: float) -> RawTest:
    return replace(test, si={**test.si, "current": np.full(len(test.time_s), current_A)})


def stated_currents(
    files: list[Path], plan: Plan, currents_A: list[float] | None
) -> list[float | None]:
    if currents_A is None:
        return [plan.columns.current_A] * len(files)
    if len(currents_A) not in (1, len(files)):
        raise UsageError(
            f"--current-a: {len(currents_A)} values for {len(files)} files; one for all or one each"
        )
    return list(currents_A) * (len(files) if len(currents_A) == 1 else 1)
