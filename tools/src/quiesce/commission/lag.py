"""How far the current in the coil lags behind its command: steps of the current, tick by tick."""

import math
from collections.abc import Sequence

import numpy as np

from quiesce.commission.samples import LOW, ticks_of
from quiesce.commission.site import Site

STEPS = 4
STEP_PART = 0.25  # of the trial's current, and back to all of it
SETTLE_S = 0.3
RECORD_S = 1.0
STREAM_S = 10
# What is left of a step: from where it surely decays to where noise would tell.
DECAY = (0.8, 0.1)
FIRST = 3  # samples that are before the step: a request takes longer
LEAST_NOISES = 20.0  # a step is so many times what the measured current wanders by
IS_MEASURED, CURRENT = "raw_sample/current_is_measured", "raw_sample/current_meas_mA"
SET = "parameters/constant_current_mA"


def measured_lag_s(site: Site, trial_mA: int) -> float | None:
    """Of the controller that holds trial_mA: median of some steps. None where they do not tell."""
    rate_Hz = int(site.rig.read("parameters/tick_rate_Hz"))
    found = []
    for i in range(STEPS):
        to_mA = trial_mA if i % 2 else max(1, round(STEP_PART * trial_mA))
        site.settle(SETTLE_S)
        lag_ticks = step_to(site, to_mA)
        found += [] if lag_ticks is None else [lag_ticks / rate_Hz]
    return float(np.median(found)) if len(found) == STEPS else None


def step_to(site: Site, to_mA: int) -> float | None:
    """Ticks."""
    site.rig.stream_raw(STREAM_S)
    got = site.rig.capture(
        (LOW, IS_MEASURED, CURRENT), RECORD_S, act=lambda: site.rig.write(SET, to_mA)
    )
    low, is_measured, current_mA = (
        np.asarray(got[name].values, np.int64) for name in (LOW, IS_MEASURED, CURRENT)
    )
    if len(low) < 2 or not is_measured.all():
        return None
    return lag_of_step(ticks_of(low), current_mA)


def lag_of_step(ticks: np.ndarray, current_mA: Sequence[int] | np.ndarray) -> float | None:
    """Time constant of a step of first order, ticks; None where there is no clear one."""
    current = np.asarray(current_mA, float)
    end = current[-max(3, len(current) // 10) :]
    before, after, noise = float(np.median(current[:FIRST])), float(np.median(end)), end.std()
    if abs(after - before) < LEAST_NOISES * max(noise, 0.5):
        return None
    left = (after - current) / (after - before)
    start = int(np.flatnonzero(left > DECAY[0])[-1]) + 1
    length = int(np.argmax(left[start:] < DECAY[1]))
    if length < 3:  # gone within three samples
        return length / math.log(DECAY[0] / DECAY[1])
    part = slice(start, start + length)
    slope = np.polyfit(ticks[part], np.log(left[part]), 1)[0]
    return float(-1.0 / slope) if slope < 0.0 else None
