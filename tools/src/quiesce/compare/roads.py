"""Roads as ground motions: random ones of ISO 8608's classes, and a bump."""

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.compare.records import Record

# Density of the height at 0.1 cycles/m in 1e-6 m^3, geometric mean of each class.
CLASSES_1e6_m3 = {"A": 16, "B": 64, "C": 256, "D": 1024, "E": 4096}
REFERENCE_1_m = 0.1
BAND_1_m = (0.011, 2.83)  # cycles a metre, the standard's
WAVES = 400
RATE_Hz = 1000.0
LASTS_s = 20.0
START_s = 0.5  # over which it comes up from flat
MOST_km_h = 300.0


def read_road(text: str) -> Record:
    """CLASS:KM_H, such as C:72, or bump:HEIGHT_M:LENGTH_M:KM_H. UsageError where it is neither."""
    kind, *rest = text.split(":")
    try:
        numbers = [float(word) for word in rest]
    except ValueError:
        numbers = []
    if kind in CLASSES_1e6_m3 and len(numbers) == 1 and 1 <= numbers[0] <= MOST_km_h:
        return road(kind, numbers[0])
    if kind == "bump" and len(numbers) == 3 and 1 <= numbers[2] <= MOST_km_h:
        height_m, length_m, speed_km_h = numbers
        if 0 < height_m <= 0.5 and 0.1 <= length_m <= 50:
            return bump(height_m, length_m, speed_km_h)
    raise UsageError(
        f"--road {text}: expected a class A to E and km/h, as in C:72, or "
        "bump:HEIGHT_M:LENGTH_M:KM_H"
    )


def road(kind: str, speed_km_h: float, seed: int = 1) -> Record:
    """The height's density falls with the square of the wave number; waves at random phases."""
    rng = np.random.default_rng([seed, ord(kind)])
    edges = np.geomspace(*BAND_1_m, WAVES + 1)
    number_1_m = np.sqrt(edges[:-1] * edges[1:])
    density = 1e-6 * CLASSES_1e6_m3[kind] * (number_1_m / REFERENCE_1_m) ** -2
    height_m = np.sqrt(2.0 * density * np.diff(edges))
    w = 2 * np.pi * number_1_m * speed_km_h / 3.6
    time_s = np.arange(0.0, LASTS_s, 1.0 / RATE_Hz)
    phase = rng.uniform(0, 2 * np.pi, WAVES)
    accel = np.zeros(len(time_s))
    for wave_m, rate, start in zip(height_m, w, phase, strict=True):
        accel -= wave_m * rate**2 * np.sin(rate * time_s + start)
    return Record(f"road_{kind}_{speed_km_h:g}", RATE_Hz, accel * np.clip(time_s / START_s, 0, 1))


def bump(height_m: float, length_m: float, speed_km_h: float) -> Record:
    """One wave 1 - cos, after a second of flat road."""
    w = 2 * np.pi * speed_km_h / 3.6 / length_m
    time_s = np.arange(0.0, 5.0, 1.0 / RATE_Hz) - 1.0
    height = 0.5 * height_m * (1.0 - np.cos(np.clip(w * time_s, 0.0, 2 * np.pi)))
    # Second differences: played with straight lines between its samples it comes back to flat.
    accel = np.concatenate([[0.0], np.diff(height, 2) * RATE_Hz**2, [0.0]])
    return Record(f"bump_{speed_km_h:g}", RATE_Hz, accel)
