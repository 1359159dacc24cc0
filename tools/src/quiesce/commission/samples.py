"""Every sample of the tracked accelerometer, in its place."""

import csv
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import BenchFailure
from quiesce.commission.site import Site

WRAP = 1 << 16  # of tick_low
STREAM_S = 10
LEAST_S, MOST_S = 0.2, 8.0  # of one capture
LEAST_PART = 0.5  # of the samples
PATIENCE_S = 120.0  # of the clock on the wall
LOW, COUNTS = "raw_sample/tick_low", "raw_sample/accel_counts"


@dataclass(frozen=True)
class Samples:
    """ticks: of each, from 0 on; where one is lost there is a gap."""

    rate_Hz: int
    ticks: np.ndarray
    counts: np.ndarray

    @property
    def mean(self) -> float:
        return float(self.counts.mean())

    @property
    def noise(self) -> float:
        """RMS, counts."""
        return float(self.counts.std())

    def power_at(self, freq_Hz: float) -> float:
        """Part of the power that one sine of this frequency explains, 0 .. 1."""
        phase = 2.0 * np.pi * freq_Hz * self.ticks / self.rate_Hz
        terms = np.column_stack([np.cos(phase), np.sin(phase), np.ones_like(phase)])
        fit, *_ = np.linalg.lstsq(terms, self.counts, rcond=None)
        total = self.counts.var()
        return 1.0 - float(np.var(self.counts - terms @ fit) / total) if total > 0.0 else 0.0

    def write(self, file: Path, unit_m_s2: float, offset_counts: int) -> None:
        """CSV, evenly sampled: what is lost is drawn between its neighbours."""
        at = np.arange(self.ticks[-1] + 1)
        values = np.interp(at, self.ticks, unit_m_s2 * (self.counts - offset_counts))
        with file.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(["time_s", "accel_m_s2"])
            for tick, value in zip(at, values, strict=True):
                writer.writerow([f"{tick / self.rate_Hz:.6g}", f"{value:.9g}"])


def ticks_of(low: np.ndarray) -> np.ndarray:
    """Of tick_low, which wraps: ticks since the first one."""
    return np.concatenate([[0], np.cumsum(np.diff(low) % WRAP)])


def take(site: Site, length_s: float) -> Samples:
    """So much of the rig's own time, which may take longer: a rig in a busy computer is slow.
    BenchFailure where the controller sends less than half of them."""
    rig, rate_Hz = site.rig, int(site.rig.read("parameters/tick_rate_Hz"))
    low, counts = np.empty(0, np.int64), np.empty(0, np.int64)
    ticks, left_s, stretch = low, length_s, 1.0
    end_s = time.monotonic() + PATIENCE_S
    while left_s > 0.0 and time.monotonic() < end_s:
        rig.stream_raw(STREAM_S)
        found = rig.capture((LOW, COUNTS), min(max(left_s, LEAST_S) * stretch, MOST_S))
        stretch *= 2.0
        low = np.concatenate([low, np.asarray(found[LOW].values, np.int64)])
        counts = np.concatenate([counts, np.asarray(found[COUNTS].values, np.int64)])
        if len(low) > 1:
            ticks = ticks_of(low)
            left_s = length_s - ticks[-1] / rate_Hz
    if left_s > 0.0 or len(low) < LEAST_PART * ticks[-1]:
        raise BenchFailure(
            f"every sample: {len(low)} came of {length_s * rate_Hz:.0f}; is the bus too slow for "
            "RawSample?"
        )
    return Samples(rate_Hz, ticks, counts)
