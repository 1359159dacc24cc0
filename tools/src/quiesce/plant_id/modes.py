"""Modes, gains and shaker roll-off from a drive sweep without current.

Maximum likelihood in the frequency domain: the structure rests before and after the sweep, so the
spectra of drive and acceleration obey Y = H U exactly, and white sensor noise has the same variance
in every bin. Model, per volt of drive:

    a = sum_i residue_i (j w)^2 / (w_i^2 - w^2 + 2 j xi_i w_i w) g(f) drive
    g(f) = sqrt((1 + (ref/corner)^2) / (1 + (f/corner)^2)), at the drive's frequency at that instant

Modes are added one after the other, each where it explains most of what is left, as long as it
explains more than noise would. Of these as many are kept as it takes to the last one that halved
what was left above the noise: a real structure never fits to the noise, and the modes that would
only mend the model's shape are no modes.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.fft import next_fast_len, rfft, rfftfreq
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

from quiesce.base.errors import UsageError
from quiesce.plant_id.recording import Part, SweepRecording

MAX_MODES = 6
# What a mode that is one leaves at most of the sum of squares above the noise.
LEFT_PART = 0.5
FIRST_DAMPING = 0.02
TRIAL_FREQUENCIES = 120
# A roll-off that begins this many times above the band is none.
FLAT_FROM = 5.0


@dataclass(frozen=True)
class Film:
    """A damper that resists without current, too: F = coefficient velocity. Arrays of n modes."""

    coefficient_N_s_m: float
    at_sensor: np.ndarray
    at_damper: np.ndarray


@dataclass(frozen=True)
class Modes:
    """A structure as the sweep shows it, without current in the damper. Arrays of n modes."""

    freq_Hz: np.ndarray
    damping_ratio: np.ndarray
    residue_m_s2_V: np.ndarray
    corner_Hz: float  # 0: the force does not depend on the frequency
    delay_s: float  # from drive to sensor
    film: Film | None = None  # None: its damping is part of the modes'

    @property
    def count(self) -> int:
        return len(self.freq_Hz)


@dataclass(frozen=True)
class SweepData:
    """The bins of one sweep that carry drive."""

    rate_Hz: int
    drive_V: np.ndarray
    drive_Hz: np.ndarray  # instantaneous frequency, a value a sample
    length: int  # of the transform
    bins: np.ndarray
    freq_Hz: np.ndarray  # of the bins
    accel: np.ndarray  # complex, in units of the noise's standard deviation
    noise: float  # that standard deviation, of real and imaginary part

    def spectrum(self, drive_V: np.ndarray) -> np.ndarray:
        return rfft(drive_V, self.length)[self.bins] / self.noise


def instantaneous_freq_Hz(drive_V: np.ndarray, rate_Hz: int) -> np.ndarray:
    """Frequency of a swept sine at each sample, from the times at which it crosses zero."""
    sign = np.signbit(drive_V)
    at = np.flatnonzero(sign[1:] != sign[:-1])
    if len(at) < 8:
        raise UsageError("the sweep has fewer than 4 periods; sweep longer or faster")
    crossing = at + drive_V[at] / (drive_V[at] - drive_V[at + 1])
    half_periods = CubicSpline(crossing, 0.5 * np.arange(len(crossing)))
    samples = np.clip(np.arange(len(drive_V)), crossing[0], crossing[-1])
    freq_Hz = rate_Hz * half_periods(samples, 1)
    # Rounded crossings of a fast sine make the derivative rough; the roll-off needs it smooth.
    width = max(1, rate_Hz // 4)
    padded = np.pad(freq_Hz, width, mode="reflect")
    smooth = np.convolve(padded, np.ones(2 * width + 1) / (2 * width + 1), mode="valid")
    return np.maximum(smooth, 1e-3)


def sweep_data(recording: SweepRecording, part: Part) -> SweepData:
    drive_V = recording.drive_V[part.before : part.next]
    first, on = part.first - part.before, part.end - part.first
    swept_Hz = instantaneous_freq_Hz(recording.drive_V[part.first : part.end], recording.rate_Hz)
    drive_Hz = np.pad(swept_Hz, (first, len(drive_V) - first - on), mode="edge")
    length = next_fast_len(len(drive_V), real=True)
    freq_Hz = rfftfreq(length, 1.0 / recording.rate_Hz)
    low_Hz, high_Hz = np.percentile(swept_Hz, [1.0, 99.0])
    bins = np.flatnonzero((freq_Hz >= low_Hz) & (freq_Hz <= high_Hz))
    noise = recording.noise_m_s2 * np.sqrt(0.5 * len(drive_V))
    accel = rfft(recording.accel_m_s2[part.before : part.next], length)[bins] / noise
    return SweepData(
        recording.rate_Hz, drive_V, drive_Hz, length, bins, freq_Hz[bins], accel, float(noise)
    )


def shaker_gain(freq_Hz: np.ndarray, corner_Hz: float, ref_freq_Hz: float) -> np.ndarray:
    """Force relative to that at ref_freq_Hz."""
    if corner_Hz == 0.0:
        return np.ones_like(freq_Hz)
    return np.sqrt((1.0 + (ref_freq_Hz / corner_Hz) ** 2) / (1.0 + (freq_Hz / corner_Hz) ** 2))


def mode_response(freq_Hz: np.ndarray, mode_Hz: float, damping_ratio: float) -> np.ndarray:
    """Acceleration per modal force of one mode."""
    return -(freq_Hz**2) / (mode_Hz**2 - freq_Hz**2 + 2j * damping_ratio * mode_Hz * freq_Hz)


def structure_response(freq_Hz: np.ndarray, modes: Modes) -> np.ndarray:
    """Acceleration per volt at ref_freq_Hz's gain, with the delay."""
    single = np.array(
        [
            mode_response(freq_Hz, mode_Hz, ratio)
            for mode_Hz, ratio in zip(modes.freq_Hz, modes.damping_ratio, strict=True)
        ]
    ).reshape(modes.count, len(freq_Hz))
    total = modes.residue_m_s2_V @ single
    if modes.film is not None:
        total = total - film_response(freq_Hz, modes, modes.film, single)
    return total * np.exp(-2j * np.pi * freq_Hz * modes.delay_s)


def film_response(freq_Hz: np.ndarray, modes: Modes, film: Film, single: np.ndarray) -> np.ndarray:
    """What the damper's force takes from the acceleration, exactly: it couples the modes.

    single [n, frequencies]: acceleration per modal force of each mode.
    """
    drive_at_damper = (film.at_damper * modes.residue_m_s2_V / film.at_sensor) @ single
    damper_at_sensor = (film.at_damper * film.at_sensor) @ single
    damper_at_damper = film.at_damper**2 @ single
    force = film.coefficient_N_s_m / (2j * np.pi * freq_Hz)
    return damper_at_sensor * force * drive_at_damper / (1.0 + force * damper_at_damper)


class SweepModel:
    """Predicts the spectra of all sweeps; remembers the last roll-off, which costs a transform."""

    def __init__(self, recording: SweepRecording, ref_freq_Hz: float) -> None:
        self.data = [sweep_data(recording, part) for part in recording.sweeps]
        self.ref_freq_Hz = ref_freq_Hz
        self._drive: dict[float, list[np.ndarray]] = {}

    def drive(self, corner_Hz: float) -> list[np.ndarray]:
        """Spectra of the drive after the roll-off, one a sweep."""
        if corner_Hz not in self._drive:
            while len(self._drive) > 4:
                del self._drive[next(iter(self._drive))]
            self._drive[corner_Hz] = [
                d.spectrum(d.drive_V * shaker_gain(d.drive_Hz, corner_Hz, self.ref_freq_Hz))
                for d in self.data
            ]
        return self._drive[corner_Hz]

    def residual(self, modes: Modes) -> np.ndarray:
        """Measured minus modelled in units of the noise: real parts, then imaginary."""
        rest = np.concatenate(
            [
                data.accel - structure_response(data.freq_Hz, modes) * drive
                for data, drive in zip(self.data, self.drive(modes.corner_Hz), strict=True)
            ]
        )
        return np.concatenate([rest.real, rest.imag])

    @property
    def freq_Hz(self) -> np.ndarray:
        return np.concatenate([data.freq_Hz for data in self.data])

    def measured(self, corner_Hz: float) -> np.ndarray:
        """Acceleration per volt, bin by bin: for plots."""
        drive = np.concatenate(self.drive(corner_Hz))
        return np.concatenate([data.accel for data in self.data]) / drive


def pack(modes: Modes) -> np.ndarray:
    """Parameters of a fit: logarithms where a value is positive."""
    theta = [*np.log(modes.freq_Hz), *np.log(modes.damping_ratio), *modes.residue_m_s2_V]
    theta.append(1e3 * modes.delay_s)
    return np.array(theta + ([np.log(modes.corner_Hz)] if modes.corner_Hz > 0.0 else []))


def unpack(theta: np.ndarray, count: int) -> Modes:
    rest = theta[3 * count + 1 :]
    return Modes(
        np.exp(theta[:count]),
        np.exp(theta[count : 2 * count]),
        theta[2 * count : 3 * count],
        float(np.exp(rest[0])) if len(rest) else 0.0,
        1e-3 * float(theta[3 * count]),
    )


def limits(model: SweepModel, modes: Modes) -> tuple[np.ndarray, np.ndarray]:
    low_Hz, high_Hz = model.freq_Hz.min(), model.freq_Hz.max()
    count = modes.count
    low = [np.log(0.5 * low_Hz)] * count + [np.log(1e-5)] * count + [-np.inf] * count + [-100.0]
    high = [np.log(2.0 * high_Hz)] * count + [0.0] * count + [np.inf] * count + [100.0]
    if modes.corner_Hz > 0.0:
        low.append(np.log(0.05 * low_Hz))
        high.append(np.log(20.0 * high_Hz))
    return np.array(low), np.array(high)


def refine(model: SweepModel, modes: Modes) -> tuple[Modes, float]:
    """The best fit from this start, and its sum of squares."""
    low, high = limits(model, modes)
    start = np.clip(pack(modes), low + 1e-9, high - 1e-9)
    fit = least_squares(
        lambda theta: model.residual(unpack(theta, modes.count)),
        start,
        bounds=(low, high),
        x_scale="jac",
        max_nfev=60,
    )
    return unpack(fit.x, modes.count), 2.0 * float(fit.cost)


def next_mode(model: SweepModel, modes: Modes) -> Modes:
    """modes and one more, at the frequency where it explains most of what is left."""
    rest = model.residual(modes)
    drive = np.concatenate(model.drive(modes.corner_Hz))
    freq_Hz = model.freq_Hz
    delay = np.exp(-2j * np.pi * freq_Hz * modes.delay_s)
    best = (-1.0, 0.0, 0.0)
    for trial_Hz in np.geomspace(freq_Hz.min(), freq_Hz.max(), TRIAL_FREQUENCIES):
        shape = mode_response(freq_Hz, trial_Hz, FIRST_DAMPING) * drive * delay
        shape = np.concatenate([shape.real, shape.imag])
        residue = float(shape @ rest / (shape @ shape))
        best = max(best, (residue**2 * float(shape @ shape), trial_Hz, residue))
    return replace(
        modes,
        freq_Hz=np.append(modes.freq_Hz, best[1]),
        damping_ratio=np.append(modes.damping_ratio, FIRST_DAMPING),
        residue_m_s2_V=np.append(modes.residue_m_s2_V, best[2]),
    )


def price(model: SweepModel, parameters: int) -> float:
    """What parameters must gain in the sum of squares."""
    return parameters * float(np.log(2 * len(model.freq_Hz)))


def candidates(
    model: SweepModel, most: int, tell: Callable[[str], None]
) -> list[tuple[Modes, float]]:
    """No mode, one mode, ... each with its sum of squares; at most `most`."""
    empty = np.empty(0)
    corner_Hz = float(np.sqrt(model.freq_Hz.min() * model.freq_Hz.max()))
    modes = Modes(empty, empty, empty, corner_Hz, 0.0)
    found = [(modes, float(np.sum(model.residual(modes) ** 2)))]
    while len(found) <= most:
        modes, cost = refine(model, next_mode(model, modes))
        # The Bayesian information criterion's price of three parameters.
        if found[-1][1] - cost < price(model, 3):
            break
        found.append((modes, cost))
        rest = np.sqrt(cost / (2 * len(model.freq_Hz)))
        tell(f"{modes.count} modes: misfit {rest:.3g} x noise")
    return found


def kept(found: list[tuple[Modes, float]], noise: float) -> int:
    """How many modes there are. noise: the sum of squares that noise alone leaves."""
    above = [max(cost - noise, 0.0) for _, cost in found]
    halved = [i for i in range(1, len(above)) if above[i] <= LEFT_PART * above[i - 1]]
    return max(halved, default=0)


def find_modes(
    model: SweepModel, count: int | None = None, tell: Callable[[str], None] = lambda _: None
) -> Modes:
    """The modes inside the swept band, sorted by frequency. count: how many, where it is known."""
    found = candidates(model, MAX_MODES if count is None else count, tell)
    number = kept(found, 2.0 * len(model.freq_Hz)) if count is None else len(found) - 1
    if number == 0:
        raise UsageError("the sweep shows no response to the drive; check the sensor and the drive")
    modes, cost = found[number]
    flat, flat_cost = refine(model, replace(modes, corner_Hz=0.0))
    scale = max(1.0, cost / (2.0 * len(model.freq_Hz)))
    if modes.corner_Hz > FLAT_FROM * model.freq_Hz.max() or (
        flat_cost - cost < scale * price(model, 1)
    ):
        modes = flat
    order = np.argsort(modes.freq_Hz)
    return replace(
        modes,
        freq_Hz=modes.freq_Hz[order],
        damping_ratio=modes.damping_ratio[order],
        residue_m_s2_V=modes.residue_m_s2_V[order],
    )
