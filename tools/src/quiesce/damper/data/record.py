"""One test as every model is fitted to it."""

from dataclasses import dataclass, fields, replace

import numpy as np

# Largest span of a command that counts as constant: part of its largest value, or A (V).
NOISE_PART = 0.05
NOISE_LEAST = 0.02


@dataclass(frozen=True)
class Record:
    """One uninterrupted test, uniformly sampled, SI units; all arrays float64 [n]."""

    name: str  # FILE, or FILE amp_mm=10 freq_hz=1 current_a=0.5
    rate_Hz: float
    time_s: np.ndarray  # as in the file, its first value kept
    disp_m: np.ndarray
    velocity_m_s: np.ndarray
    accel_m_s2: np.ndarray
    force_N: np.ndarray
    command: np.ndarray  # coil current in A, or the voltage as it stands
    command_unit: str  # "A" or "V"
    temperature_C: np.ndarray | None = None
    average_samples: int = 1  # centred moving average, odd, that the model's output gets, too
    file_rows: float = 1.0  # rows of the file for one row of the record

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def duration_s(self) -> float:
        return len(self) / self.rate_Hz

    @property
    def level(self) -> float | None:
        """The command where it is constant but for noise, else None."""
        spread = float(np.ptp(self.command))
        limit = max(NOISE_PART * float(np.abs(self.command).max()), NOISE_LEAST)
        return float(np.median(self.command)) if spread <= limit else None

    def rows(self, first: int, end: int) -> "Record":
        """The rows first .. end - 1 as a record of their own."""
        cut = {
            field.name: value[first:end]
            for field in fields(self)
            if isinstance(value := getattr(self, field.name), np.ndarray)
        }
        return replace(self, **cut)

    def averaged(self, values: np.ndarray) -> np.ndarray:
        """The centred moving average that the file's force went through; shorter at the ends."""
        if self.average_samples == 1:
            return values
        ones = np.ones(self.average_samples)
        sums = np.convolve(values, ones, mode="same")
        return sums / np.convolve(np.ones(len(values)), ones, mode="same")
