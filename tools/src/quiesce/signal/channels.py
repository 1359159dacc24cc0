"""Which column of a recording is which sensor of a board: NAME=COLUMN:UNIT."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.engine.board import Board, Sensor
from quiesce.signal.recording import COLUMN_UNITS, Recording
from quiesce.signal.resample import resample

WORD = re.compile(r"([^=]+)=(.+):([^:]+)")
NO_SAMPLE = -(2**31)  # a count that no sensor has


@dataclass(frozen=True)
class Channel:
    column: str
    per_unit: float  # how many of the sensor's unit 1 in the column is


def read_channel(word: str, board: Board) -> tuple[str, Channel]:
    """The sensor's name, and what it is fed from."""
    match = WORD.fullmatch(word)
    if match is None:
        raise UsageError(f"--sensor {word}: expected NAME=COLUMN:UNIT")
    name, column, unit = match.groups()
    sensor = next((one for one in board.sensors if one.name == name), None)
    if sensor is None:
        there = ", ".join(one.name for one in board.sensors)
        raise UsageError(
            f"--sensor {word}: board {board.name} has no sensor '{name}'; there are: {there}"
        )
    units = COLUMN_UNITS[sensor.unit]
    if unit not in units:
        raise UsageError(
            f"--sensor {word}: {name} measures {sensor.measures.replace('_', ' ')}; "
            f"the unit is one of: {', '.join(units)}"
        )
    return name, Channel(column, units[unit])


def read_channels(words: Sequence[str], board: Board) -> dict[str, Channel]:
    """By the name of the sensor."""
    channels: dict[str, Channel] = {}
    for word in words:
        name, channel = read_channel(word, board)
        if name in channels:
            raise UsageError(f"--sensor {word}: a second column for {name}")
        channels[name] = channel
    if board.tracked.name not in channels:
        raise UsageError(
            f"--sensor: no column for {board.tracked.name}, whose frequency and RMS the "
            f"controller follows on board {board.name}; add "
            f"--sensor {board.tracked.name}=COLUMN:UNIT"
        )
    return channels


def sampled(recording: Recording, channel: Channel, sensor: Sensor, rate_Hz: int) -> np.ndarray:
    """Counts of a sensor tick by tick; without a sample where none is due."""
    values = recording.columns[channel.column] * channel.per_unit
    counts = sensor.counts(resample(values, recording.rate_Hz, rate_Hz))
    counts[~sensor.is_due(len(counts), rate_Hz)] = NO_SAMPLE
    return counts


def tick_counts(
    recording: Recording, sensors: Sequence[Sensor], channels: dict[str, Channel], rate_Hz: int
) -> np.ndarray:
    """[tick, sensor]; a sensor without a channel never has a sample."""
    rows = {
        name: sampled(recording, channel, next(s for s in sensors if s.name == name), rate_Hz)
        for name, channel in channels.items()
    }
    silent = np.full_like(next(iter(rows.values())), NO_SAMPLE)
    return np.stack([rows.get(sensor.name, silent) for sensor in sensors], axis=1)
