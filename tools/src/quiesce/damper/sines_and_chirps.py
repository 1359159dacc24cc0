"""The published tests of the self-tuning fuzzy model, in parts of a damper's limits: 24 sines of
one amplitude, and chirps.

With a stroke of 12.5 mm, 1.5 A and a rig up to 2.5 Hz they are those of the RD-1005-3: 5 mm at 1,
1.5, 2 and 2.5 Hz, each at 0, 0.5, 0.75, 1, 1.25 and 1.5 A; chirps from 1 to 2.5 Hz at 0, 0.5, 1 and
1.5 A; 5000 samples of 2 ms. Source: STF model of the RD-1005-3 damper, Table 2, Figs 19 to 22.
"""

import numpy as np

from quiesce.damper.plan import Damper, Plan, Test, test_of, warnings_of

FREQ_PARTS = (0.4, 0.6, 0.8, 1.0)
SINE_LEVELS = (0.0, 1.0 / 3.0, 1.0 / 2.0, 2.0 / 3.0, 5.0 / 6.0, 1.0)
CHIRP_LEVELS = (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0)
DURATION_s = 10.0
RATE_Hz = 500.0
# Rows a period at least, where the rig is faster than the source's.
_ROWS_A_PERIOD = 50.0


def make_plan(damper: Damper) -> Plan:
    tests = [
        _test(damper, "sine", f"sine_{freq_Hz:.3g}Hz", freq_Hz, freq_Hz, level)
        for freq_Hz in (part * damper.rig_max_Hz for part in FREQ_PARTS)
        for level in SINE_LEVELS
    ]
    low_Hz = FREQ_PARTS[0] * damper.rig_max_Hz
    tests += [
        _test(damper, "chirp", "chirp", low_Hz, damper.rig_max_Hz, level) for level in CHIRP_LEVELS
    ]
    rate_Hz = max(RATE_Hz, _ROWS_A_PERIOD * float(np.ceil(damper.rig_max_Hz)))
    return Plan(damper, rate_Hz, tests, warnings_of(damper, tests))


def _test(
    damper: Damper, kind: str, label: str, freq_Hz: float, fastest_Hz: float, level: float
) -> Test:
    """Of the source's duration, or ten periods where that is longer."""
    duration_s = max(DURATION_s, 10.0 / freq_Hz)
    speed_m_s = 2.0 * np.pi * fastest_Hz * damper.amplitude_m
    current_A = round(level * damper.max_current_A, 6)
    return test_of(
        damper, kind, label, damper.amplitude_m, speed_m_s, duration_s, current_A, round(freq_Hz, 9)
    )
