"""The figures of a comparison as smooth functions of a motion, with their slopes: peaks and largest
values are p-norms, which come down to them as the sharpness p grows."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from quiesce.compare.figures import Contact
from quiesce.compare.weighting import wk
from quiesce.compare.zones import BAND_Hz
from quiesce.plant.open_loop import Motion

Floats = NDArray[np.float64]
VDV_POWER = 4


@dataclass(frozen=True)
class Layout:
    """Columns of a motion as a board has them: bodies from the base up, and what is on the base."""

    bodies: tuple[int, ...]  # of the motion's places
    contacts: tuple[tuple[int, Contact], ...]  # the place of each
    rate_Hz: float


@dataclass(frozen=True)
class _Signal:
    """Part of a motion [ticks k], and what its slopes are for the motion's."""

    values: Floats
    give_back: Callable[[Floats, Motion], None]


def slopes_of(
    name: str, motion: Motion, layout: Layout, sharpness: float, weight: float, slopes: Motion
) -> float:
    """The figure, smoothed; adds weight times its slopes to those."""
    signal_of, norm = SMOOTH[name]
    signal = signal_of(motion, layout)
    value, own = norm(signal.values, sharpness)
    signal.give_back(weight * own, slopes)
    return value


def _peak(values: Floats, sharpness: float) -> tuple[float, Floats]:
    """Of all columns together."""
    top = max(float(np.abs(values).max()), 1e-300)
    parts = np.abs(values) / top
    high = parts ** (sharpness - 1.0)
    size = float((high * parts).sum()) ** (1.0 / sharpness)
    return top * size, np.sign(values) * high * size ** (1.0 - sharpness)


def _largest_rms(values: Floats, sharpness: float) -> tuple[float, Floats]:
    each = np.maximum(np.sqrt(np.mean(values**2, axis=0)), 1e-300)
    largest, share = _peak(each, sharpness)
    return largest, share * values / (each * len(values))


def _rms(values: Floats, sharpness: float) -> tuple[float, Floats]:
    """Of all columns together."""
    size = max(float(np.sqrt(np.mean(values**2))), 1e-300)
    return size, values / (size * values.size)


def _mean(values: Floats, sharpness: float) -> tuple[float, Floats]:
    return float(values.mean()), np.full(values.shape, 1.0 / values.size)


def _dose(values: Floats, sharpness: float) -> tuple[float, Floats]:
    """Fourth root of the sum of fourth powers."""
    size = max(float((values**VDV_POWER).sum()) ** (1.0 / VDV_POWER), 1e-300)
    return size, (values / size) ** (VDV_POWER - 1)


def _last(motion: Motion, layout: Layout) -> _Signal:
    body = layout.bodies[-1]

    def give_back(own: Floats, slopes: Motion) -> None:
        slopes.disp_m[:, body] += 1e3 * own[:, 0]

    return _Signal(1e3 * motion.disp_m[:, [body]], give_back)


def _drifts(motion: Motion, layout: Layout) -> _Signal:
    bodies = list(layout.bodies)

    def give_back(own: Floats, slopes: Motion) -> None:
        # A body's motion counts for the drift below it, and against the one above.
        above = np.append(own[:, 1:], np.zeros((len(own), 1)), axis=1)
        slopes.disp_m[:, bodies] += 1e3 * (own - above)

    return _Signal(1e3 * np.diff(motion.disp_m[:, bodies], axis=1, prepend=0.0), give_back)


def _accels(motion: Motion, layout: Layout) -> _Signal:
    bodies = list(layout.bodies)

    def give_back(own: Floats, slopes: Motion) -> None:
        slopes.accel_m_s2[:, bodies] += own

    return _Signal(motion.accel_m_s2[:, bodies], give_back)


def _forces(motion: Motion, layout: Layout) -> _Signal:
    def give_back(own: Floats, slopes: Motion) -> None:
        slopes.force_N[:] += own

    return _Signal(motion.force_N, give_back)


def _strokes(motion: Motion, layout: Layout) -> _Signal:
    def give_back(own: Floats, slopes: Motion) -> None:
        slopes.stroke_m[:] += 1e3 * own

    return _Signal(1e3 * motion.stroke_m, give_back)


def _currents(motion: Motion, layout: Layout) -> _Signal:
    def give_back(own: Floats, slopes: Motion) -> None:
        slopes.coil_A[:] += own

    return _Signal(motion.coil_A, give_back)


@lru_cache(maxsize=8)
def _felt_response(size: int, rate_Hz: float) -> NDArray[np.complex128]:
    return wk(np.fft.rfftfreq(size, 1.0 / rate_Hz))


def _felt(motion: Motion, layout: Layout) -> _Signal:
    """As weighting.weighted."""
    body, count = layout.bodies[-1], len(motion.accel_m_s2)
    size = 2 ** int(np.ceil(np.log2(2 * count)))
    response = _felt_response(size, layout.rate_Hz)

    def through(values: Floats, by: NDArray[np.complex128]) -> Floats:
        return np.fft.irfft(np.fft.rfft(values, size) * by, size)[:count]

    def give_back(own: Floats, slopes: Motion) -> None:
        slopes.accel_m_s2[:, body] += through(own[:, 0], response.conj())

    return _Signal(through(motion.accel_m_s2[:, body], response)[:, None], give_back)


def _dosed(motion: Motion, layout: Layout) -> _Signal:
    """So that the fourth root of its sum of fourth powers is the dose."""
    felt, scale = _felt(motion, layout), layout.rate_Hz ** (-1.0 / VDV_POWER)
    return _Signal(scale * felt.values, lambda own, slopes: felt.give_back(scale * own, slopes))


def _speeds(motion: Motion, layout: Layout) -> _Signal:
    """In mm/s, as weighting.velocity_rms_mm_s."""
    bodies, count = list(layout.bodies), len(motion.accel_m_s2)
    freq_Hz = np.fft.rfftfreq(count, 1.0 / layout.rate_Hz)
    inside = (freq_Hz >= BAND_Hz[0]) & (freq_Hz <= BAND_Hz[1])
    response = np.zeros((len(freq_Hz), 1), complex)
    response[inside, 0] = 1e3 / (2j * np.pi * freq_Hz[inside])

    def through(values: Floats, by: NDArray[np.complex128]) -> Floats:
        return np.fft.irfft(np.fft.rfft(values, axis=0) * by, count, axis=0)

    def give_back(own: Floats, slopes: Motion) -> None:
        slopes.accel_m_s2[:, bodies] += through(own, response.conj())

    return _Signal(through(motion.accel_m_s2[:, bodies], response), give_back)


def _loads(motion: Motion, layout: Layout) -> _Signal:
    """What each contact's load varies by about its mean, over its preload; as figures.figures_of:
    a speed is the gradient of the way."""
    rate_Hz, columns, masks = layout.rate_Hz, [], []
    for place, one in layout.contacts:
        way_m = motion.disp_m[:, place]
        load_N = one.stiffness_N_m * way_m + one.damping_N_s_m * np.gradient(way_m, 1.0 / rate_Hz)
        masks.append(load_N < one.preload_N)
        load = np.minimum(load_N / one.preload_N, 1.0)
        columns.append(load - load.mean())

    def give_back(own: Floats, slopes: Motion) -> None:
        for k, (place, one) in enumerate(layout.contacts):
            of_load = np.where(masks[k], own[:, k] - own[:, k].mean(), 0.0) / one.preload_N
            slopes.disp_m[:, place] += (
                one.stiffness_N_m * of_load
                + one.damping_N_s_m * rate_Hz * _gradient_back(of_load)
            )  # fmt: skip

    return _Signal(np.column_stack(columns), give_back)


def _gradient_back(own: Floats) -> Floats:
    """The transpose of numpy.gradient at unit spacing."""
    out = np.zeros_like(own)
    out[2:] += 0.5 * own[1:-1]
    out[:-2] -= 0.5 * own[1:-1]
    out[0] -= own[0]
    out[1] += own[0]
    out[-1] += own[-1]
    out[-2] -= own[-1]
    return out


# Of every figure that has slopes: a count, a decision and a variation have none that help.
SMOOTH: dict[
    str,
    tuple[
        Callable[[Motion, Layout], _Signal], Callable[[Floats, float], tuple[float, Floats]]
    ],
] = {
    "disp_peak_mm": (_last, _peak),
    "disp_rms_mm": (_last, _rms),
    "drift_peak_mm": (_drifts, _peak),
    "drift_rms_mm": (_drifts, _largest_rms),
    "accel_peak_m_s2": (_accels, _peak),
    "accel_rms_m_s2": (_accels, _largest_rms),
    "force_peak_N": (_forces, _peak),
    "current_mean_A": (_currents, _mean),
    "current_rms_A": (_currents, _rms),
    "weighted_m_s2": (_felt, _rms),
    "vdv_m_s175": (_dosed, _dose),
    "velocity_rms_mm_s": (_speeds, _largest_rms),
    "tyre_share": (_loads, _largest_rms),
    "rattle_mm": (_strokes, _peak),
}  # fmt: skip
