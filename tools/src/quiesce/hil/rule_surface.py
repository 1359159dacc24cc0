"""A rule base as a surface, from the firmware itself by way of the bench."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.engine.bench import Bench
from quiesce.engine.trace import Trace


@dataclass(frozen=True)
class RuleSurface:
    freq_Hz: np.ndarray
    rms_m_s2: np.ndarray
    current_A: np.ndarray  # [rms, freq]


def rule_surface(bench: Bench, table: Path | None = None) -> RuleSurface:
    """Of the rules that ship, or of a table file's."""
    data = bench.json("fuzzy-surface", *(("--rules", str(table)) if table else ()))
    freq_Hz, rms_m_s2 = np.array(data["freq_Hz"]), np.array(data["rms_m_s2"])
    current_A = np.array(data["current_A"])
    return RuleSurface(freq_Hz, rms_m_s2, current_A.reshape(len(freq_Hz), len(rms_m_s2)).T)


def visited_cells(surface: RuleSurface, trace: Trace) -> tuple[np.ndarray, np.ndarray]:
    """Grid points nearest to the inputs of the rule base, while its frequency was valid."""
    valid = trace["freq_is_valid"] > 0
    freq = nearest(surface.freq_Hz, trace["freq_uHz"][valid] * 1e-6)
    rms = nearest(surface.rms_m_s2, trace["rms_um_s2"][valid] * 1e-6)
    cells = np.unique(np.stack([freq, rms]), axis=1)
    return surface.freq_Hz[cells[0]], surface.rms_m_s2[cells[1]]


def nearest(grid: np.ndarray, values: np.ndarray) -> np.ndarray:
    step = grid[1] - grid[0]
    return np.clip(np.rint((values - grid[0]) / step), 0, len(grid) - 1).astype(int)
