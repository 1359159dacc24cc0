"""Writes the files of a new plant: all of them once they are checked and have run, or none."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.engine.bench import Bench
from quiesce.plant.library import SAFE_PART, Plant, USUAL_STEP_us
from quiesce.plant.new.order import Order, make_plan, with_step
from quiesce.plant.new.text import (
    BOARD,
    DAMPER,
    PLANT,
    RANDOM,
    SENSOR,
    STEPS,
    Plan,
    board_text,
    plant_text,
    random_text,
    steps_text,
)
from quiesce.plant.new.trial import Trial, run_trial

# Of accelerometers that are sold; the controller's accelerations end at 500 m/s2.
RANGES_g = (2.0, 4.0, 8.0, 16.0, 50.0)
SPARE = 2.0  # times the peak at 0 A
HALVINGS = 12
TRACKED_Hz = (1.0, 50.0)  # what the controller's tracker reports


@dataclass(frozen=True)
class Made:
    """Finished files, and how the plant moves without current and at the largest one."""

    plan: Plan
    names: list[str]
    at_rest: Trial
    at_full: Trial
    notes: list[str]


def make(order: Order) -> Made:
    """UsageError where what was said contradicts itself or does not run: nothing is written."""
    bench = Bench()
    plan = make_plan(order, RANGES_g[-1] if order.range_g is None else order.range_g)
    names = list(texts(plan))
    require_free(order, names)
    with output_files(order.folder) as staging:
        plan = with_step(plan, safe_step_us(plan, staging))
        write(plan, staging)
        at_rest = tried(bench, plan, staging)
        plan = replace(plan, range_g=chosen_range_g(order, at_rest.peak_m_s2))
        write(plan, staging)
        check(bench, staging, names)
        at_full = run_trial(bench, staging, math.floor(1e3 * plan.damper.max_current + 1e-9))
    return Made(plan, names, at_rest, at_full, notes_of(plan, at_rest))


def texts(plan: Plan) -> dict[str, str]:
    out = {PLANT: plant_text(plan), BOARD: board_text(plan), DAMPER: plan.damper.text}
    if plan.sensor is not None:
        out[SENSOR] = plan.sensor.text
    out[STEPS] = steps_text(plan)
    if not plan.drive.is_single:
        out[RANDOM] = random_text(plan)
    return out


def write(plan: Plan, folder: Path) -> None:
    for name, text in texts(plan).items():
        (folder / name).write_text(text, encoding="utf-8")


def require_free(order: Order, names: list[str]) -> None:
    if order.folder.exists() and not order.folder.is_dir():
        raise UsageError(f"{shown(order.folder)} is a file; name a folder for --out")
    there = [name for name in names if (order.folder / name).exists()]
    if there and not order.is_forced:
        raise UsageError(
            f"{shown(order.folder)} has {', '.join(there)} already; --force overwrites, or name "
            "another folder for --out"
        )


def told(error: UsageError, folder: Path) -> str:
    """Without the folder that is not there any more."""
    return one_line(str(error)).replace(f"{folder}/", "")


def safe_step_us(plan: Plan, folder: Path) -> float | None:
    """None where the usual step does."""
    write(with_step(plan, 1.0), folder)
    try:
        safe_us = 1e6 * Plant(folder / PLANT).safe_step_s
    except UsageError as error:
        raise UsageError(f"this plant does not go: {told(error, folder)}") from None
    return None if safe_us >= USUAL_STEP_us else float(f"{SAFE_PART * safe_us:.2g}")


def tried(bench: Bench, plan: Plan, folder: Path) -> Trial:
    """Without current. UsageError, with a level that does, where that does not run."""
    try:
        return run_trial(bench, folder, 0)
    except UsageError as error:
        reason = told(error, folder).partition("; reduce")[0]
        raise UsageError(
            f"--drive {plan.drive.text}: at 0 A {reason}{remedy(bench, plan, folder)}"
        ) from None


def remedy(bench: Bench, plan: Plan, folder: Path) -> str:
    for halvings in range(1, HALVINGS + 1):
        level = plan.drive.level / 2**halvings
        write(replace(plan, drive=replace(plan.drive, level=level)), folder)
        try:
            run_trial(bench, folder, 0)
        except UsageError:
            continue
        return f"; at {level:.3g} {plan.drive.unit} it runs"
    return ""


def chosen_range_g(order: Order, peak_m_s2: float) -> float:
    """UsageError where the one that was asked for is too small."""
    needed_g = peak_m_s2 / 9.80665
    if order.range_g is not None:
        if order.range_g < needed_g:
            raise UsageError(
                f"--range {order.range_g:g}: without current the accelerometer sees "
                f"{needed_g:.3g} g"
            )
        return order.range_g
    fitting = [one for one in RANGES_g if one >= SPARE * needed_g]
    if not fitting:
        raise UsageError(
            f"--drive {order.drive}: {needed_g:.3g} g without current; the controller takes "
            f"+-{RANGES_g[-1]:g} g, and twice the peak is wanted: name a lower level, or --range"
        )
    return fitting[0]


def check(bench: Bench, folder: Path, names: list[str]) -> None:
    """By the checks of a user."""
    try:
        bench.call("plant-check", str(folder / PLANT))
        bench.call("board-check", str(folder / BOARD))
        for name in (STEPS, RANDOM):
            if name in names:
                bench.call("scenario-check", str(folder / name))
    except UsageError as error:
        raise UsageError(told(error, folder)) from None


def notes_of(plan: Plan, at_rest: Trial) -> list[str]:
    """What runs, but on ground that nobody has tested."""
    damper, drive = plan.damper, plan.drive
    notes = []
    if drive.low_Hz < TRACKED_Hz[0] or drive.high_Hz > TRACKED_Hz[1]:
        notes.append(f"--drive goes beyond the {TRACKED_Hz[0]:g} to {TRACKED_Hz[1]:g} Hz that the "
                     "controller tracks")  # fmt: skip
    known = damper.freqs_Hz
    if known and (drive.low_Hz < known[0] or drive.high_Hz > known[1]):
        text = f"{known[0]:g} to {known[1]:g} Hz" if known[0] < known[1] else f"{known[0]:g} Hz"
        notes.append(f"the damper was identified at {text} only")
    if damper.stroke_m and at_rest.stroke_um > 1e6 * damper.stroke_m:
        notes.append(f"without current its stroke is {1e-3 * at_rest.stroke_um:.3g} mm, and it was "
                     f"tested with {1e3 * damper.stroke_m:.3g} mm")  # fmt: skip
    return notes
