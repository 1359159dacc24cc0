"""Where a constant current costs acceleration: what to hold in setting balanced while a motion
there has no steady component to lock on to."""

from collections.abc import Sequence
from typing import Any

import numpy as np

COSTS_PTS = 1.0  # of the acceleration without current, against the best constant
SPARED_PTS = 2.0  # at most so much worse than the best one, over the band
BELOW_PART = 0.8  # of the first frequency: what costs there costs below, too
# Of the acceleration without current: of less, the damper at full current hardly moves.
LEAST_PART = 1.0 / 3.0
NEVER: dict[str, int | str] = {"narrow_current_mA": 0, "narrow_low_mHz": 0,
                               "narrow_high_mHz": 0, "narrow_least_um_s2": 0}  # fmt: skip


def narrow_parameters(
    freqs_Hz: Sequence[float], found: Sequence[dict[str, Any]], unlock_mA: int
) -> dict[str, int | str]:
    """Of the run of neighbouring frequencies in which unlock_mA costs most. found: of each
    frequency constants (the same ones) and figures without control, as tune's work stores them."""
    levels_mA = [round(1e3 * one["current_A"]) for one in found[0]["constants"]]
    accel_pct = np.array([[one["accel_red_pct"] for one in row["constants"]] for row in found])
    unlock = int(np.argmin([abs(level - unlock_mA) for level in levels_mA]))
    costs = accel_pct.max(axis=1) - accel_pct[:, unlock]
    run = dearest_run(costs)
    if run is None:
        return dict(NEVER)
    mean_pct = accel_pct[run].mean(axis=0)
    spared = np.flatnonzero(mean_pct >= mean_pct.max() - SPARED_PTS)
    without = [row["uncontrolled"]["accel_rms_mm_s2"] for row in found[run]]
    low_Hz, high_Hz = edges_Hz(freqs_Hz, run)
    return {
        "narrow_current_mA": levels_mA[int(spared[-1])],
        "narrow_low_mHz": round(1e3 * low_Hz),
        "narrow_high_mHz": round(1e3 * high_Hz),
        "narrow_least_um_s2": round(1e3 * LEAST_PART * float(np.mean(without))),
    }


def dearest_run(costs: np.ndarray) -> slice | None:
    """Of neighbours that cost COSTS_PTS or more; None where none does."""
    is_dear = np.concatenate([[False], costs >= COSTS_PTS, [False]])
    starts = np.flatnonzero(~is_dear[:-1] & is_dear[1:])
    ends = np.flatnonzero(is_dear[:-1] & ~is_dear[1:])
    runs = [slice(int(start), int(end)) for start, end in zip(starts, ends, strict=True)]
    return max(runs, key=lambda run: float(costs[run].sum()), default=None)


def edges_Hz(freqs_Hz: Sequence[float], run: slice) -> tuple[float, float]:
    """Half way to the neighbours that are not of the run; at the table's ends, see BELOW_PART."""
    first, last = freqs_Hz[run.start], freqs_Hz[run.stop - 1]
    low_Hz = 0.5 * (freqs_Hz[run.start - 1] + first) if run.start else BELOW_PART * first
    high_Hz = 0.5 * (last + freqs_Hz[run.stop]) if run.stop < len(freqs_Hz) else last
    return low_Hz, high_Hz
