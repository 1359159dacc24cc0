"""The firmware's windowed RMS against float64 over the same samples.

The reference conditions the counts as firmware/sense/condition.h states it, in float64: scale,
polarity, offset, first-order DC removal that starts from the plain mean. The window is the last
whole 10 ms blocks.
"""

import numpy as np
from quiesce.signal.replay import own_sensor

from quiesce_benchmarks.signal.records import Rig

BLOCK_ms = 10


def conditioned(counts: np.ndarray, params: dict[str, int]) -> np.ndarray:
    """Acceleration in m/s2 without its DC part; records x ticks, every sample good."""
    scale = params["accel_polarity"] * params["accel_scale_nm_s2"] * 1e-9
    accel = (counts.astype(float) - params["accel_offset_counts"]) * scale
    omega = 2.0 * np.pi * params["dc_cutoff_mHz"] * 1e-3 / params["tick_rate_Hz"]
    slow_gain = omega / (1.0 + omega)
    dc = accel[:, 0].copy()
    rest = np.empty_like(accel)
    for tick in range(accel.shape[1]):
        rest[:, tick] = accel[:, tick] - dc
        dc += max(slow_gain, 1.0 / (tick + 1)) * rest[:, tick]
    return rest


def windowed_rms(values: np.ndarray, block_ticks: int, window_blocks: int) -> np.ndarray:
    """RMS of the last window_blocks blocks at the end of each block that fills a window."""
    count = values.shape[1] // block_ticks
    blocks = np.square(values[:, : count * block_ticks])
    sums = blocks.reshape(len(values), count, block_ticks).sum(axis=2)
    windows = np.lib.stride_tricks.sliding_window_view(sums, window_blocks, axis=1).sum(axis=2)
    return np.sqrt(windows / (window_blocks * block_ticks))


def rms_error(rig: Rig, accel_m_s2: np.ndarray, rms_um_s2: np.ndarray) -> float:
    """Largest relative error of the telemetry (every tick) over all full windows."""
    params = rig.params
    block_ticks = params["tick_rate_Hz"] * BLOCK_ms // 1000
    window_blocks = params["rms_window_ms"] // BLOCK_ms
    values = conditioned(own_sensor(params).counts(accel_m_s2), params)
    expected = windowed_rms(values, block_ticks, window_blocks)
    told = rms_um_s2[:, block_ticks - 1 :: block_ticks] * 1e-6
    told = told[:, window_blocks - 1 : window_blocks - 1 + expected.shape[1]]
    return float(np.max(np.abs(told / expected - 1.0)))
