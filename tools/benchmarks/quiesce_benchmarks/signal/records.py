"""Many synthetic records through the firmware, a fresh controller for each, and what it told.

Arrays are records x ticks. Times are in ticks from the start of a record.
"""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.params import effective_params
from quiesce.engine.trace import read_trace
from quiesce.signal.replay import own_sensor

# In place of a count: no sample came in this tick (quiesce_bench replay).
NO_SAMPLE = np.iinfo(np.int32).min
# Amplitude of the tones and the gravity that a vertical sensor shows under them.
AMPLITUDE_m_s2 = 0.5
OFFSET_m_s2 = 9.80665
# Signal-to-noise ratios are per sample at this rate; a faster tick has more noise in each sample.
SNR_RATE_Hz = 1000
WRONG_SHARE = 0.10
# Goal of the time from a step to the first tick that is not valid.
NOTICE_s = 0.030
_CALL_TICKS = 1_500_000


@dataclass(frozen=True)
class Rig:
    """The firmware with its parameters, on the host."""

    bench: Bench
    settings: Sequence[str]
    params: dict[str, int]

    @property
    def rate_Hz(self) -> int:
        return self.params["tick_rate_Hz"]

    @property
    def longest_window_ms(self) -> int:
        return self.params["track_window_ms"]

    @property
    def band_Hz(self) -> tuple[float, float]:
        return self.params["band_low_mHz"] * 1e-3, self.params["band_high_mHz"] * 1e-3

    def ticks(self, time_s: float) -> int:
        return round(time_s * self.rate_Hz)

    def run(
        self,
        accel_m_s2: np.ndarray,
        columns: Sequence[str],
        missing: np.ndarray | None = None,
        from_tick: int = 0,
        every: int = 1,
    ) -> dict[str, np.ndarray]:
        """Telemetry words of each record by name, from a tick on and every so many ticks.

        missing: where no sample comes. Words are int32; no column may need 32 unsigned bits.
        """
        counts = own_sensor(self.params).counts(accel_m_s2)
        if missing is not None:
            counts[missing] = NO_SAMPLE
        step = max(1, _CALL_TICKS // counts.shape[1])
        parts = [
            self._call(counts[first : first + step], columns, from_tick, every)
            for first in range(0, len(counts), step)
        ]
        return {name: np.concatenate([part[name] for part in parts]) for name in columns}

    def _call(
        self, counts: np.ndarray, columns: Sequence[str], from_tick: int, every: int
    ) -> dict[str, np.ndarray]:
        with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
            counts_file, trace_file = Path(folder) / "counts", Path(folder) / "trace"
            counts.tofile(counts_file)
            self.bench.call(
                "replay", "--counts", str(counts_file), "--trace", str(trace_file),
                "--record-ticks", str(counts.shape[1]), "--columns", ",".join(columns),
                "--from-tick", str(from_tick), "--every", str(every), "--law", "off",
                *setting_options(self.settings),
            )  # fmt: skip
            trace = read_trace(trace_file)
        return {name: trace[name].astype(np.int32).reshape(len(counts), -1) for name in columns}


def make_rig(settings: Sequence[str]) -> Rig:
    """UsageError for settings that the controller refuses."""
    bench = Bench()
    return Rig(bench, settings, effective_params(bench, settings))


def log_uniform(rng: np.random.Generator, low: float, high: float, count: int) -> np.ndarray:
    return np.exp(rng.uniform(np.log(low), np.log(high), count))


def random_phase(rng: np.random.Generator, count: int) -> np.ndarray:
    return rng.uniform(-np.pi, np.pi, count)


def noise_rms(amplitude: np.ndarray | float, snr_dB: float, rate_Hz: int) -> np.ndarray | float:
    """RMS of the white noise of one sample: SNR = amplitude^2 / (2 noise^2) at SNR_RATE_Hz."""
    return amplitude / np.sqrt(2.0) * 10.0 ** (-snr_dB / 20.0) * np.sqrt(rate_Hz / SNR_RATE_Hz)


def tone(
    freq_Hz: np.ndarray, phase_rad: np.ndarray, at_tick: np.ndarray | int, ticks: int, rate_Hz: int
) -> np.ndarray:
    """cos(2 pi f t + phase) with t = 0 at at_tick of each record."""
    shift = np.broadcast_to(np.asarray(at_tick), freq_Hz.shape)
    time_s = (np.arange(ticks)[None, :] - shift[:, None]) / rate_Hz
    return np.cos(2.0 * np.pi * freq_Hz[:, None] * time_s + phase_rad[:, None])


def switched(before: np.ndarray, after: np.ndarray, at_tick: np.ndarray) -> np.ndarray:
    """`before` up to at_tick of each record, `after` from it on."""
    return np.where(np.arange(before.shape[1])[None, :] < at_tick[:, None], before, after)


def with_noise(
    clean_m_s2: np.ndarray, noise_m_s2: np.ndarray | float, rng: np.random.Generator
) -> np.ndarray:
    """The signal over gravity, with white noise of this RMS (one a record, or one for all)."""
    noise = rng.standard_normal(clean_m_s2.shape)
    return clean_m_s2 + OFFSET_m_s2 + noise * np.reshape(noise_m_s2, (-1, 1))


@dataclass
class Tally:
    """Ticks whose frequency was valid but more than 10 % off."""

    ticks: int = 0
    valid: int = 0
    wrong: int = 0
    # Of those, the ones later after a change than the chain may take to notice it.
    wrong_late: int = 0

    def add(
        self,
        freq_uHz: np.ndarray,
        is_valid: np.ndarray,
        truth_Hz: np.ndarray,
        is_late: np.ndarray | bool = True,
    ) -> None:
        """truth_Hz and is_late: of each tick, or broadcast to it."""
        valid = is_valid > 0
        wrong = valid & (np.abs(freq_uHz * 1e-6 - truth_Hz) > WRONG_SHARE * truth_Hz)
        self.ticks += valid.size
        self.valid += int(valid.sum())
        self.wrong += int(wrong.sum())
        self.wrong_late += int((wrong & is_late).sum())

    def join(self, other: "Tally") -> None:
        self.ticks += other.ticks
        self.valid += other.valid
        self.wrong += other.wrong
        self.wrong_late += other.wrong_late

    @property
    def wrong_pct(self) -> float:
        return 100.0 * self.wrong / self.ticks if self.ticks else 0.0


def tally_switched(
    rig: Rig,
    out: dict[str, np.ndarray],
    before_Hz: np.ndarray,
    after_Hz: np.ndarray,
    at_tick: np.ndarray,
) -> Tally:
    """Of records whose frequency changes at at_tick."""
    since = np.arange(out["freq_uHz"].shape[1])[None, :] - at_tick[:, None]
    truth_Hz = np.where(since < 0, before_Hz[:, None], after_Hz[:, None])
    is_late = (since < 0) | (since > rig.ticks(NOTICE_s))
    tally = Tally()
    tally.add(out["freq_uHz"], out["freq_is_valid"], truth_Hz, is_late)
    return tally
