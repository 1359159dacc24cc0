"""Pictures of a report: before in grey, after in blue."""

from typing import Any

import numpy as np

from quiesce.before_after import thirds
from quiesce.before_after.figures import Found
from quiesce.before_after.integrate import integrated
from quiesce.before_after.levels import BLOCKS
from quiesce.before_after.pairs import SIDES, Pair
from quiesce.before_after.response import Response
from quiesce.report.plot_style import COLORS, pyplot, svg_of

COLOR = {"before": COLORS["current"], "after": COLORS["main"]}
SHOWN_PART = 0.3  # of |H1|, down to which its interval is drawn
MOST_POINTS = 1200  # of a curve; more make a large file and no better picture
SIZE = (9.0, 3.4)
OCTAVES_Hz = (
    0.063, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 31.5, 63.0, 125.0, 250.0, 500.0, 1000.0,
    2000.0, 4000.0, 8000.0, 16000.0,
)  # fmt: skip


def motion_over_time(pair: Pair, band_Hz: tuple[float, float]) -> str:
    """Both on one scale, in the report's band."""
    plt = pyplot()
    figure, axes = plt.subplots(2, 1, figsize=(9.0, 4.2), sharex=True, sharey=True)
    for axis, name, side in zip(axes, SIDES, pair.sides, strict=True):
        values = pair.motion.per_si * integrated(side.values, side.rate_Hz, 0, *band_Hz)
        low, high = _envelope(values)
        time_s = np.linspace(0.0, len(values) / side.rate_Hz, len(low))
        axis.fill_between(time_s, low, high, color=COLOR[name], linewidth=0.5, label=name)
        axis.set_ylabel(f"{name}, {pair.motion.unit}")
    axes[1].set_xlabel("time, s")
    return svg_of(figure)


def _envelope(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest value of each of at most MOST_POINTS stretches."""
    size = max(2, -(-len(values) // MOST_POINTS))
    parts = values[: len(values) // size * size].reshape(-1, size)
    return parts.min(axis=1), parts.max(axis=1)


def density(found: Found, band_Hz: tuple[float, float]) -> str:
    plt = pyplot()
    figure, axis = plt.subplots(figsize=SIZE)
    motion = found.pair.motion
    for side, one in zip(SIDES, found.spectra, strict=True):
        freq_Hz, power = _thinned(one.freq_Hz, one.density(), band_Hz)
        axis.plot(freq_Hz, _decibels(motion.per_si**2 * power, 10.0), color=COLOR[side], label=side)
    axis.set_ylabel(f"dB re 1 ({motion.unit})²/Hz")
    _frequencies(axis, band_Hz)
    axis.legend()
    return svg_of(figure)


def third_octaves(found: Found, band_Hz: tuple[float, float]) -> str:
    """ "" where no band is wide enough for the records."""
    if not found.bands:
        return ""
    plt = pyplot()
    figure, axis = plt.subplots(figsize=SIZE)
    places = np.arange(len(found.bands))
    for i, side in enumerate(SIDES):
        values = np.array([sides[i].value for sides in found.bands.values()])
        ends = np.array([sides[i].interval() for sides in found.bands.values()]).T
        reach = np.abs(_decibels(ends, 20.0) - _decibels(values, 20.0))
        axis.errorbar(
            places + 0.24 * (i - 0.5), _decibels(values, 20.0), yerr=reach, fmt="os"[i],
            color=COLOR[side], label=side, markersize=4, capsize=2, linewidth=0.9,
        )  # fmt: skip
    axis.set_xticks(places, [f"{thirds.nominal_Hz(index):g}" for index in found.bands], rotation=60)
    axis.set_xlabel("one-third-octave band, Hz")
    axis.set_ylabel(f"RMS, dB re 1 {found.pair.motion.unit}")
    axis.legend()
    return svg_of(figure)


def transmissibility(found: Found, band_Hz: tuple[float, float]) -> str:
    """ "" without a reference."""
    if found.answer is None:
        return ""
    plt = pyplot()
    figure, (upper, lower) = plt.subplots(
        2, 1, figsize=(9.0, 5.0), sharex=True, height_ratios=(3, 2)
    )
    for side, one in zip(SIDES, found.answer.responses, strict=True):
        _draw_response(upper, lower, side, one, band_Hz)
    unit = found.answer.unit
    upper.set_ylabel("|H1|, dB" + (f" re 1 {unit}" if unit else ""))
    lower.set_ylabel("coherence")
    lower.set_ylim(0.0, 1.02)
    _frequencies(lower, band_Hz)
    upper.legend()
    return svg_of(figure)


def _draw_response(
    upper: Any, lower: Any, side: str, one: Response, band_Hz: tuple[float, float]
) -> None:
    inside = (one.freq_Hz >= band_Hz[0]) & (one.freq_Hz <= band_Hz[1])
    step = max(1, int(inside.sum()) // MOST_POINTS)
    freq_Hz, size, reach = (
        values[inside][::step] for values in (one.freq_Hz, np.abs(one.h1), one.reach)
    )
    low = np.maximum(size - reach, SHOWN_PART * size)  # may be nothing at all
    upper.plot(freq_Hz, _decibels(size, 20.0), color=COLOR[side], label=side)
    upper.fill_between(
        freq_Hz, _decibels(low, 20.0), _decibels(size + reach, 20.0), color=COLOR[side], alpha=0.2,
        linewidth=0,
    )  # fmt: skip
    lower.plot(freq_Hz, one.coherence[inside][::step], color=COLOR[side])
    lower.axhline(one.chance_coherence, color=COLOR[side], linestyle=":")


def steadiness(found: Found) -> str:
    plt = pyplot()
    figure, axis = plt.subplots(figsize=(9.0, 2.6))
    for side, values in zip(SIDES, found.block_rms, strict=True):
        axis.step(np.arange(1, BLOCKS + 1), values, where="mid", color=COLOR[side], label=side)
    axis.set_ylim(bottom=0.0)
    axis.set_xticks([1, *range(5, BLOCKS + 1, 5)])
    axis.set_xlabel("twentieth of the record")
    axis.set_ylabel(f"RMS, {found.pair.motion.unit}")
    axis.legend()
    return svg_of(figure)


def _thinned(
    freq_Hz: np.ndarray, power: np.ndarray, band_Hz: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Inside the band; the means of neighbours where there are more than MOST_POINTS."""
    inside = (freq_Hz >= band_Hz[0]) & (freq_Hz <= band_Hz[1])
    freq_Hz, power = freq_Hz[inside], power[inside]
    edges = np.geomspace(band_Hz[0], band_Hz[1] * 1.000001, MOST_POINTS + 1)
    places = np.digitize(freq_Hz, edges)
    used, counts = np.unique(places, return_counts=True)
    sums = [np.bincount(places, values)[used] for values in (freq_Hz, power)]
    return sums[0] / counts, sums[1] / counts


def _decibels(values: np.ndarray, factor: float) -> np.ndarray:
    return factor * np.log10(np.maximum(values, np.finfo(float).tiny))


def _frequencies(axis: Any, band_Hz: tuple[float, float]) -> None:
    """A logarithmic axis with the names of octaves."""
    ticks = [f for f in OCTAVES_Hz if band_Hz[0] <= f <= band_Hz[1]]
    axis.set_xscale("log")
    axis.set_xlim(*band_Hz)
    axis.set_xticks(ticks, [f"{f:g}" for f in ticks])
    axis.minorticks_off()
    axis.set_xlabel("frequency, Hz")
