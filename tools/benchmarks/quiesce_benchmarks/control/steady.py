"""Steady sines over the band: the law against constants, the fuzzy law and the bound."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from quiesce.engine.trace import Trace

from quiesce_benchmarks.control.measures import (
    converge_s,
    dither_loss_pct,
    fraction_of,
    reduction_pct,
    second_amplitudes,
)
from quiesce_benchmarks.control.rig import (
    BALANCED,
    DISPLACEMENT,
    SETTINGS,
    Control,
    Reduction,
    Rig,
    constant,
)
from quiesce_benchmarks.control.ruler import Bound, Ruler
from quiesce_benchmarks.control.scenarios import steady

SHIPPED_s = 8.0  # without adaptation
POINTS_Hz = (5.0, 10.0, 15.0, 20.0)
TRACE_COLUMNS = ("t_s", "x5_um")
# From here on the law must not be worse than full constant current.
CONSTANT_FROM_Hz = 10.0
FUZZY = Control("fuzzy")


@dataclass(frozen=True)
class Point:
    """One frequency on the plant as it is. Keys of `adapted` and `shipped` are the settings."""

    freq_Hz: float
    open_loop: dict[str, float]  # amp_um, accel_rms_mm_s2
    full: Reduction  # constant current, all that the driver gives
    fuzzy: Reduction
    adapted: dict[str, Reduction]  # adaptation on, after adapt_s from a cold start
    shipped: dict[str, Reduction]  # the table as it is, after SHIPPED_s
    converge_s: dict[str, float]
    dither_loss_pct: dict[str, float]

    def found(self) -> list[Reduction]:
        return [self.full, self.fuzzy, *self.adapted.values(), *self.shipped.values()]

    def row(self) -> dict[str, Any]:
        return asdict(self)


def amplitudes(trace: Trace | None, freq_Hz: float) -> np.ndarray:
    """Of each second of a steady run."""
    assert trace is not None
    return second_amplitudes(trace["t_s"], trace["x5_um"], freq_Hz)


def measure_point(rig: Rig, freq_Hz: float, adapt_s: float) -> Point:
    short, long = steady(freq_Hz, SHIPPED_s), steady(freq_Hz, adapt_s)
    base = rig.run(short, Control("off")).figures

    def against_base(figures: dict[str, Any]) -> Reduction:
        return Reduction(
            reduction_pct(figures["amp_um"], base["amp_um"]),
            reduction_pct(figures["accel_rms_mm_s2"], base["accel_rms_mm_s2"]),
            figures["mean_current_A"],
        )

    runs = {
        name: rig.run(long, rig.judged.control(name), columns=TRACE_COLUMNS) for name in SETTINGS
    }
    over_time = {name: amplitudes(run.trace, freq_Hz) for name, run in runs.items()}
    return Point(
        freq_Hz=freq_Hz,
        open_loop={key: base[key] for key in ("amp_um", "accel_rms_mm_s2")},
        full=against_base(rig.run(short, constant(rig.full_A)).figures),
        fuzzy=against_base(rig.run(short, FUZZY).figures),
        adapted={name: against_base(run.figures) for name, run in runs.items()},
        shipped={
            name: against_base(rig.run(short, rig.judged.control(name, "off")).figures)
            for name in SETTINGS
        },
        converge_s={name: converge_s(values) for name, values in over_time.items()},
        dither_loss_pct={
            name: dither_loss_pct(values, base["amp_um"]) for name, values in over_time.items()
        },
    )


@dataclass(frozen=True)
class Sweep:
    """The worst over the band; None where no bound is known."""

    displacement_min_fraction: float | None
    balanced_min_fraction: float | None
    balanced_min_accel_pct: float
    worst_below_constant_pts: float | None  # None: no frequency that high


def judge_sweep(points: Sequence[Point], ruler: Ruler) -> Sweep:
    bounds = {point.freq_Hz: ruler.bound(point.freq_Hz) for point in points}
    below = [
        point.full.amp_pct - point.adapted[name].amp_pct
        for point in points
        for name in SETTINGS
        if point.freq_Hz >= CONSTANT_FROM_Hz
    ]
    return Sweep(
        least([fraction(p, DISPLACEMENT, bounds[p.freq_Hz]) for p in points]),
        least([fraction(p, BALANCED, bounds[p.freq_Hz]) for p in points]),
        min(point.adapted[BALANCED].accel_pct for point in points),
        max(below, default=None),
    )


def fraction(point: Point, setting: str, bound: Bound) -> float | None:
    """Share of what the setting could reach at most; None where that is not known."""
    limit = bound.amp_pct if setting == DISPLACEMENT else bound.balanced_amp_pct
    return None if limit is None else fraction_of(point.adapted[setting].amp_pct, limit)


def least(values: Sequence[float | None]) -> float | None:
    """None where one of them is: a minimum of some is not the minimum."""
    known = [value for value in values if value is not None]
    return min(known) if known and len(known) == len(values) else None
