"""How much a vibration is felt: ISO 2631-1's vertical weighting Wk, and its doses."""

import numpy as np

from quiesce.compare.zones import BAND_Hz

# Corners in Hz and quality factors of ISO 2631-1, annex A: band limits, transition, step.
LOW_Hz, HIGH_Hz, BAND_Q = 0.4, 100.0, 1.0 / np.sqrt(2.0)
TRANSITION_Hz, TRANSITION_Q = 12.5, 0.63
STEP_Hz, STEP_Q, STEP_END_Hz, STEP_END_Q = 2.37, 0.91, 3.35, 0.91


def wk(freq_Hz: np.ndarray) -> np.ndarray:
    """Wk, complex, for a vertical acceleration."""
    s = 2j * np.pi * np.asarray(freq_Hz, dtype=float)

    def second(corner_Hz: float, q: float) -> np.ndarray:
        w = 2.0 * np.pi * corner_Hz
        return 1.0 + s / (q * w) + (s / w) ** 2

    low = (s / (2 * np.pi * LOW_Hz)) ** 2 / second(LOW_Hz, BAND_Q)
    high = 1.0 / second(HIGH_Hz, BAND_Q)
    transition = (1.0 + s / (2 * np.pi * TRANSITION_Hz)) / second(TRANSITION_Hz, TRANSITION_Q)
    step = second(STEP_Hz, STEP_Q) / second(STEP_END_Hz, STEP_END_Q) * (STEP_Hz / STEP_END_Hz) ** 2
    return low * high * transition * step


def weighted(accel_m_s2: np.ndarray, rate_Hz: float) -> np.ndarray:
    """Through Wk, from rest; as long as what comes in."""
    count = len(accel_m_s2)
    size = 2 ** int(np.ceil(np.log2(2 * count)))  # what the filter rings on for does not come round
    freq_Hz = np.fft.rfftfreq(size, 1.0 / rate_Hz)
    return np.fft.irfft(np.fft.rfft(accel_m_s2, size) * wk(freq_Hz), size)[:count]


def vibration_dose(weighted_m_s2: np.ndarray, rate_Hz: float) -> float:
    """VDV in m/s^1.75."""
    return float((np.sum(weighted_m_s2**4) / rate_Hz) ** 0.25)


def velocity_rms_mm_s(accel_m_s2: np.ndarray, rate_Hz: float) -> float:
    """In the band of ISO 20816-3, of what is not beyond half the rate."""
    spectrum = np.fft.rfft(accel_m_s2)
    freq_Hz = np.fft.rfftfreq(len(accel_m_s2), 1.0 / rate_Hz)
    inside = (freq_Hz >= BAND_Hz[0]) & (freq_Hz <= BAND_Hz[1])
    velocity = spectrum[inside] / (2j * np.pi * freq_Hz[inside])
    # Parseval, both halves of the spectrum.
    return float(1e3 * np.sqrt(2.0 * np.sum(np.abs(velocity) ** 2)) / len(accel_m_s2))
