"""Two masses with a damper and an elastomer on a vibration table, beside the published ratios."""

import numpy as np
from quiesce.base.table import format_table

from quiesce_benchmarks.laws.two_masses import (
    CONTROLS,
    PUBLISHED_E,
    SCENARIOS,
    Found,
    PUBLISHED_m_s2,
    measured,
    ratios,
)
from quiesce_benchmarks.part import Effort, Measured

TITLE = "elastomer: damper and elastomer mount, published ratios of acceleration"
FIGURES = (
    ("mrd_mre_worst_peak_error", "of uncontrolled", 0.1, "lower"),
    ("mrd_mre_worst_rms_error", "of uncontrolled", None, "lower"),
)


def measure(effort: Effort) -> Measured:
    """One run tells all six ratios: the noise of the sensors hardly moves them."""
    found = measured(effort.seed)
    values: dict[str, float | None] = {
        "mrd_mre_worst_peak_error": found.worst_peak_error,
        "mrd_mre_worst_rms_error": found.worst_rms_error,
    }
    return Measured(values, reported(found), (table(found),))


def reported(found: Found) -> dict[str, dict[str, list[float]]]:
    """By motion of the table: of every control, then of both beside uncontrolled."""
    values = {
        "peak_m_s2": found.peak_m_s2,
        "peak_ratios": ratios(found.peak_m_s2),
        "E_ratios": ratios(found.rms_m_s2),
    }
    return {
        key: dict(zip(SCENARIOS, np.round(rows, 4).tolist(), strict=True))
        for key, rows in values.items()
    }


def table(found: Found) -> str:
    """Of the upper mass: peaks, and ratios to uncontrolled of peaks and of E."""
    rows = []
    for i, name in enumerate(SCENARIOS):
        for who, peaks, rms in (
            (name, found.peak_m_s2, found.rms_m_s2),
            ("  published", PUBLISHED_m_s2, PUBLISHED_E),
        ):
            cells = [f"{value:.2f}" for value in peaks[i]]
            cells += [f"{value:.3f}" for value in (*ratios(peaks)[i], *ratios(rms)[i])]
            rows.append([who, *cells])
    head = [
        "",
        *(f"{name}, m/s2" for name in CONTROLS),
        "peak: damper",
        "both",
        "E: damper",
        "both",
    ]
    return format_table(head, rows)
