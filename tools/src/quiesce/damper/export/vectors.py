"""Motions with the forces that the bench's own model gives: what an exported model is held to."""

from dataclasses import dataclass

import numpy as np

from quiesce.damper import library
from quiesce.damper.command_range import command_unit, largest_command
from quiesce.damper.data.record import Record
from quiesce.damper.export.laws import SPEED_m_s
from quiesce.damper.model_file import DamperModel, opened
from quiesce.damper.simulate import simulator

SAMPLES = 120  # of each run
PER_PERIOD = 64
SLOW_Hz, FAST_Hz = 0.5, 20.0
STATED = 1.0  # A or V, where a file states no largest command


@dataclass(frozen=True)
class Run:
    """From rest: what the model sees and the force in N that the bench's model gives."""

    record: Record
    force_N: np.ndarray


def runs_of(damper: DamperModel) -> list[Run]:
    """At half and at full command, and with a command that moves. Half of the speed that the file
    states, within its stroke."""
    most = largest_command(damper) or STATED
    moving = 0.5 * most * (1.0 + np.sin(np.arange(SAMPLES) / 9.0))
    still = [np.full(SAMPLES, level) for level in (0.5 * most, most)]
    speed_m_s = damper.speed_m_s or SPEED_m_s
    freq_Hz = float(np.clip(speed_m_s / (2.0 * np.pi * 0.5 * damper.stroke_m), SLOW_Hz, FAST_Hz))
    # As many steps as samples, so that the steps do not depend on where the command is.
    quick_Hz = max(freq_Hz, 1.1 * fastest_1_s(damper, moving) / PER_PERIOD)
    unit = command_unit(damper)
    records = [two_tones(speed_m_s, freq_Hz, command, unit) for command in still]
    records.append(two_tones(speed_m_s, quick_Hz, moving, unit))
    return [Run(record, bench_force_N(damper, record)) for record in records]


def two_tones(speed_m_s: float, freq_Hz: float, command: np.ndarray, unit: str) -> Record:
    rate_Hz = PER_PERIOD * freq_Hz
    time_s = np.arange(len(command)) / rate_Hz
    disp, velocity, accel = (np.zeros(len(time_s)) for _ in range(3))
    for part, times in ((0.35, 1.0), (0.1, 2.7)):
        w = 2.0 * np.pi * freq_Hz * times
        disp += part * speed_m_s / w * np.sin(w * time_s)
        velocity += part * speed_m_s * np.cos(w * time_s)
        accel -= part * speed_m_s * w * np.sin(w * time_s)
    zero = np.zeros(len(time_s))
    return Record("vectors", rate_Hz, time_s, disp, velocity, accel, zero, command, unit)


def fastest_1_s(damper: DamperModel, command_A: np.ndarray) -> float:
    """Bound of how fast the states change, at the speed that the file states."""
    if not damper.is_kernel:
        return max(opened(damper).fastest_rate_1_s(float(one)) for one in command_A)
    one, orders, row = damper.kernel_row()
    rate_of = library.module().fastest_rate_1_s
    return max(
        rate_of(one.name, library.values_at(one, orders, row, current_A), damper.speed_m_s)
        for current_A in (library.effective_A(damper.rig, float(one)) for one in command_A)
    )


def bench_force_N(damper: DamperModel, record: Record) -> np.ndarray:
    """The bench's model along the record, in the steps that the file's speed asks for."""
    if not damper.is_kernel:
        return simulator(damper)(record)
    one, orders, row = damper.kernel_row()
    ends = np.array([record.command.min(), record.command.max()])
    steps = library.substeps_for(fastest_1_s(damper, ends), record.rate_Hz)
    return library.simulate(one, orders, row, library.motion(record), steps)[0]
