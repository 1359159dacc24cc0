"""Figures as people read them."""

from math import isfinite, log10

from quiesce.before_after.figures import Figure, Found
from quiesce.before_after.levels import Ratio

NAMES = {
    "acceleration_rms": "acceleration, RMS",
    "acceleration_typical_peak": "acceleration, typical peak",
    "acceleration_peak": "acceleration, peak",
    "velocity_rms": "velocity, RMS",
    "velocity_typical_peak": "velocity, typical peak",
    "velocity_peak": "velocity, peak",
    "displacement_rms": "displacement, RMS",
    "displacement_typical_peak": "displacement, typical peak",
    "displacement_peak": "displacement, peak",
    "crest": "crest factor",
    "kurtosis": "kurtosis",
    "zone_velocity_rms": "velocity in the zones' band, RMS",
    "weighted_rms": "felt acceleration (Wk), RMS",
    "normalised_rms": "RMS under the same input",
    "transmissibility_peak": "largest transmissibility",
}


def number(value: float) -> str:
    """Four digits that count, without an exponent where it can be."""
    return f"{value:.4g}" if 1e-4 <= abs(value) < 1e6 or value == 0.0 else f"{value:.3e}"


def percent(ratio: float) -> str:
    return f"{100.0 * (ratio - 1.0):+.1f} %"


def interval(ratio: Ratio | None) -> str:
    if ratio is None:
        return "-"
    return f"{100.0 * (ratio.low - 1.0):+.1f} to {100.0 * (ratio.high - 1.0):+.1f}"


def span(ratio: Ratio, sign: float) -> str:
    """The interval of a change in per cent, small end first."""
    ends = sorted(sign * 100.0 * (end - 1.0) for end in (ratio.low, ratio.high))
    return f"{ends[0]:.0f} to {ends[1]:.0f}"


def headline(found: Found) -> str:
    """What happened to the RMS of what is measured, in one sentence."""
    motion = found.pair.motion.name
    lines = [changed(f"RMS {motion} of {found.pair.name}", found.figure(f"{motion}_rms"))]
    if (normalised := found.figure("normalised_rms")) is not None:
        lines.append(changed("Under the same input it", normalised))
    return " ".join(lines)


def changed(what: str, figure: Figure | None) -> str:
    assert figure is not None and figure.ratio is not None
    ratio = figure.ratio
    if not ratio.is_certain:
        return f"{what} did not change for sure: {percent(ratio.value)} ({interval(ratio)})."
    sign = -1.0 if ratio.value < 1.0 else 1.0
    verb = "fell" if ratio.value < 1.0 else "rose"
    return f"{what} {verb} by {abs(100.0 * (ratio.value - 1.0)):.0f} % ({span(ratio, sign)})."


HEAD = ("quantity", "unit", "before", "after", "change", "95 % interval, %", "dB")


def rows(found: Found) -> list[tuple[str, ...]]:
    return [_row(one) for one in found.figures]


def _row(figure: Figure) -> tuple[str, ...]:
    change = figure.change
    dB = f"{20.0 * log10(change):+.1f}" if isfinite(change) and change > 0.0 else "-"
    return (
        NAMES[figure.quantity], figure.unit, number(figure.before), number(figure.after),
        percent(change), interval(figure.ratio), dB,
    )  # fmt: skip
