"""The force of a damper file's model along a record, whatever its model is."""

from pathlib import Path

import numpy as np

from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.library import DamperFile
from quiesce.damper.model_file import DamperModel, opened, read_model
from quiesce.damper.score import Simulate


def simulator_of_file(file: Path) -> tuple[DamperModel, Simulate]:
    """The model and its force in N, rig and coil lag included. UsageError for a bad file."""
    damper = read_model(file)
    if damper.is_kernel:
        return damper, simulator(damper)
    # The file itself: keys that only its own model knows stay as they are.
    return damper, with_rig(DamperFile(file), dict(damper.rig))


def simulator(damper: DamperModel) -> Simulate:
    """The force in N of a damper model along a record, with its rig: lag, mass, skew, offset."""
    if damper.is_kernel:
        one, orders, row = damper.kernel_row()
        return lambda record: library.simulate_row(one, orders, row, record)
    return with_rig(opened(damper), dict(damper.rig))


def with_rig(model: DamperFile, rig: dict[str, float]) -> Simulate:
    """A model that is not a kernel, with what the rig adds (library.RIG)."""
    value = {name: float(rig.get(name, 0.0)) for name in library.RIG}

    def simulate(record: Record) -> np.ndarray:
        current = lagged(record.command, record.rate_Hz, value["rise_s"], value["fall_s"])
        skew_s = value["skew_s"]
        motion = library.module().Motion(
            record.rate_Hz,
            np.ascontiguousarray(record.disp_m - skew_s * record.velocity_m_s),
            np.ascontiguousarray(record.velocity_m_s - skew_s * record.accel_m_s2),
            np.ascontiguousarray(record.accel_m_s2),
            current,
        )
        force_N = model.simulate(motion, model.substeps(record))
        elapsed_s = np.arange(len(record)) / record.rate_Hz
        return (
            force_N
            + value["inertia_kg"] * record.accel_m_s2
            + value["offset_N"]
            + value["drift_N_s"] * elapsed_s
        )

    return simulate


def lagged(command: np.ndarray, rate_Hz: float, rise_s: float, fall_s: float) -> np.ndarray:
    """The coil's current: first order, a rise and a fall each with its own time constant; exact
    for a command that is straight lines' means between the samples."""
    current = np.ascontiguousarray(command, dtype=float).copy()
    if rise_s <= 0.0 and fall_s <= 0.0:
        return current
    for k in range(1, len(current)):
        target = 0.5 * (command[k - 1] + command[k])
        time_constant_s = rise_s if target > current[k - 1] else fall_s
        left = np.exp(-1.0 / (rate_Hz * time_constant_s)) if time_constant_s > 1e-9 else 0.0
        is_direct = left == 0.0
        current[k] = command[k] if is_direct else target + (current[k - 1] - target) * left
    return current
