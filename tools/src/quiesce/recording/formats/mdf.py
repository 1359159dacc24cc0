"""MDF of data loggers, by asammdf: measured channels on one time axis."""

from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.base.progress import say
from quiesce.recording.arrays import ArrayTable, with_unit
from quiesce.recording.formats.mdf_channels import channels, opened, samples_of
from quiesce.recording.table import Table

KIND = "MDF file"


def read(file: Path) -> Table:
    """Channels with numbers, at the times of the fastest one: slower ones are interpolated there,
    straight, within the time that all share, and it is said. UsageError where none has two."""
    found: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    with opened(file) as mdf:
        for name, place, unit in channels(mdf):
            signal = samples_of(mdf, place)
            if signal is not None and len(signal[0]) > 1:
                found[with_unit(name, unit)] = signal
    if not found:
        raise UsageError(f"{shown(file)}: no measured channels with numbers in this {KIND}")
    for name, (time_s, _) in found.items():
        if (np.diff(time_s) <= 0.0).any():
            raise UsageError(f"{shown(file)}: times of channel {name} step back; export it again")
    fastest = max(found, key=lambda name: _rate_Hz(found[name][0]))
    first_s = max(time_s[0] for time_s, _ in found.values())
    last_s = min(time_s[-1] for time_s, _ in found.values())
    time_s = found[fastest][0]
    time_s = time_s[(time_s >= first_s) & (time_s <= last_s)]
    if len(time_s) < 2:
        raise UsageError(f"{shown(file)}: its channels share no time; export what belongs together")
    columns, slower = {"time [s]": time_s}, []
    for name, (own_s, values) in found.items():
        columns[name] = np.interp(time_s, own_s, values)  # exact where the times are the same
        slower += [] if np.isin(time_s, own_s).all() else [name]
    remark = f"channels at the times of {fastest}"
    if slower:
        remark += f", interpolated straight: {', '.join(slower)}"
        say(f"{shown(file)}: {remark}")
    return ArrayTable(file, list(columns), list(columns.values()), KIND, remark)


def _rate_Hz(time_s: Any) -> float:
    return float((len(time_s) - 1) / max(time_s[-1] - time_s[0], 1e-12))
