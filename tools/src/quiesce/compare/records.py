"""Recorded ground motions: CSV, or the AT2 files of strong-motion archives."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.compare.names import ACCEL, TIME
from quiesce.signal.recording import M_S2_PER_UNIT, read_recording

AT2_HEAD_LINES = 4
MOST_ROWS = 5_000_000
MOST_m_s2 = 1e4


@dataclass(frozen=True)
class Record:
    """Acceleration of the ground at n / rate_Hz."""

    name: str
    rate_Hz: float
    accel_m_s2: np.ndarray

    @property
    def peak_m_s2(self) -> float:
        return float(np.abs(self.accel_m_s2).max())

    @property
    def duration_s(self) -> float:
        return (len(self.accel_m_s2) - 1) / self.rate_Hz

    def csv(self) -> str:
        """As the bench reads it."""
        times = np.arange(len(self.accel_m_s2)) / self.rate_Hz
        rows = zip(times, self.accel_m_s2, strict=True)
        return f"{TIME},{ACCEL}\n" + "".join(f"{t:.9g},{a:.9g}\n" for t, a in rows)


def read_record(file: Path, time_column: str = TIME, accel_column: str = ACCEL) -> Record:
    """UsageError, naming the line where there is one, for anything that is no ground motion. The
    unit of a CSV file's acceleration is the end of its column's name: _m_s2, _mm_s2 or _g."""
    record = (
        read_at2(file)
        if file.suffix.lower() == ".at2"
        else _read_csv(file, time_column, accel_column)
    )
    if not record.peak_m_s2 > 0:
        raise UsageError(f"{shown(file)}: all of it is 0; there is nothing to shake with")
    if record.peak_m_s2 > MOST_m_s2:
        raise UsageError(f"{shown(file)}: a peak of {record.peak_m_s2:.3g} m/s2; in which unit?")
    return record


def _read_csv(file: Path, time_column: str, accel_column: str) -> Record:
    unit = next((one for one in M_S2_PER_UNIT if accel_column.endswith("_" + one)), None)
    if unit is None:
        raise UsageError(f"column {accel_column}: its name ends in its unit: _m_s2, _mm_s2 or _g")
    found = read_recording(file, [accel_column], time_column)
    return Record(file.stem, found.rate_Hz, found.accel_m_s2(accel_column, unit))


def read_at2(file: Path) -> Record:
    """Four lines of head, the last one with NPTS and DT, then numbers in g, several a line."""
    try:
        lines = file.read_text(encoding="ascii", errors="strict").splitlines()
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a ground motion")
    except UnicodeDecodeError:
        raise UsageError(f"{shown(file)}: not a text file")
    head = " ".join(lines[:AT2_HEAD_LINES])
    points = re.search(r"NPTS\s*=?\s*(\d+)", head, re.IGNORECASE)
    step = re.search(r"DT\s*=?\s*([0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)", head, re.IGNORECASE)
    if points is None or step is None or not 1e-5 <= float(step[1]) <= 1.0:
        raise UsageError(f"{shown(file)}: no NPTS and DT in its first {AT2_HEAD_LINES} lines")
    values = _numbers(file, lines[AT2_HEAD_LINES:])
    if not 2 <= int(points[1]) <= MOST_ROWS or len(values) != int(points[1]):
        raise UsageError(f"{shown(file)}: {len(values)} numbers where NPTS says {points[1]}")
    return Record(file.stem, 1.0 / float(step[1]), values * M_S2_PER_UNIT["g"])


def _numbers(file: Path, lines: list[str]) -> np.ndarray:
    found: list[float] = []
    for number, line in enumerate(lines, AT2_HEAD_LINES + 1):
        try:
            found += [float(word) for word in line.split()]
        except ValueError:
            raise UsageError(f"{shown(file)} line {number}: expected numbers only")
    values = np.array(found)
    if not np.isfinite(values).all():
        raise UsageError(f"{shown(file)}: not all of its numbers are finite")
    return values
