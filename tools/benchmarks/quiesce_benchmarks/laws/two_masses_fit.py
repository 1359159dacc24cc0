"""A search for what the publication of the two masses does not print: masses, spring, lever, gains,
and how the table shakes.

`python -m quiesce_benchmarks.laws.two_masses_fit SEED [SECONDS]`, in tools/benchmarks, prints what
it finds beside the published ratios; the bench has the last word (two_masses.py)."""

import ctypes
import subprocess
import sys
import time
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
from quiesce.base.paths import root
from quiesce.base.table import format_table
from scipy.optimize import differential_evolution

from quiesce_benchmarks.laws.two_masses import (
    DAMPER,
    DAMPER_A,
    MOUNT,
    MOUNT_A,
    PUBLISHED_E,
    PUBLISHED_m_s2,
    ratios,
)

# Frequencies without a common period, and the phases they begin with, in radians.
TONES_Hz = np.array([6.1, 9.7, 14.3, 19.9, 26.3, 33.7, 41.9, 53.3])
PHASES = np.array([0.0, 2.1, 4.4, 1.3, 5.2, 3.1, 0.7, 2.6])
TILT_FROM_Hz = 20.0
# What is looked for, logarithms to the base 10 but for the last: lowest and highest.
SOUGHT = {
    "lower_kg": (0.3, 2.0),
    "upper_kg": (0.3, 2.0),
    "spring_N_m": (4.0, 6.0),
    "damping_N_s_m": (-0.2, 2.7),
    "ratio": (-1.5, -0.2),
    "sky_N_s_m": (2.0, 5.5),
    "limit_N": (1.3, 3.5),
    "mount_N_s_m": (2.0, 5.5),
    "at_10Hz_m_s2": (-0.4, 1.3),
    "at_40Hz_m_s2": (0.4, 1.8),
    "not_periodic_m_s2": (-0.4, 1.6),
    "tilt": (-2.0, 2.0),  # of the tones' amplitudes, a power of the frequency
}
RIG_SIZE = 8  # of those, the rig's and its laws'
DURATION_s, FROM_s, STEP_s, HOLD = 4.0, 2.0, 2.5e-4, 4
MOST_STROKE_m = 1.5e-3  # of the mount, 3 mm thick
POPULATION = 48


@dataclass(frozen=True)
class Modelled:
    """Rows: 10 Hz, 40 Hz, not periodic; columns: uncontrolled, damper, both."""

    peak_m_s2: np.ndarray
    rms_m_s2: np.ndarray
    stroke_m: np.ndarray


@cache
def library() -> ctypes.CDLL:
    file = Path(mkdtemp(prefix="quiesce-laws-")) / "model.so"
    source = Path(__file__).with_name("two_masses_model.c")
    subprocess.run(
        ["cc", "-std=c11", "-O3", "-ffast-math", "-march=native", "-shared", "-fPIC"]
        + ["-o", file, source, "-lm"],
        check=True,
    )
    return ctypes.CDLL(str(file))


@cache
def dampers() -> tuple[np.ndarray, np.ndarray]:
    """Damper and mount from their files, with their largest currents and coils' lags."""
    folder = root() / "sim_hil/data/dampers"
    one, other = (
        tomllib.loads((folder / f"{name}.toml").read_text(encoding="utf-8"))
        for name in (DAMPER, MOUNT)
    )
    p, m = one["parameters"], other["parameters"]
    of_damper = [
        *p["c_N_s_m"], *p["k_N_m"], *p["alpha_N"], p["beta_s_m"], *p["delta"], *p["f0_N"],
        p["x_s_m"], DAMPER_A, 0.010,
    ]  # fmt: skip
    stiffness = 1e6 * m["area_m2"] / m["thickness_m"] * np.array(m["storage_MPa"])
    loss_s = m["loss_factor"] / (2.0 * np.pi * m["loss_freq_Hz"])
    of_mount = [*stiffness, loss_s, MOUNT_A, other["coil"]["rise_s"]]
    return np.array(of_damper), np.array(of_mount)


def tones(values: np.ndarray) -> list[list[tuple[float, float, float]]]:
    """Frequency, amplitude in m/s2 and phase in radians of each motion of the base."""
    at_10Hz, at_40Hz, size, tilt = values[RIG_SIZE:]
    shape = (TONES_Hz / TILT_FROM_Hz) ** tilt
    amplitudes = size * shape / np.linalg.norm(shape)
    rest = zip(TONES_Hz, amplitudes, PHASES, strict=True)
    return [[(10.0, at_10Hz, 0.0)], [(40.0, at_40Hz, 0.0)], list(rest)]


def base(motions: Sequence[Sequence[tuple[float, float, float]]]) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration and velocity of the base, [motions steps]."""
    t = STEP_s * np.arange(round(DURATION_s / STEP_s))
    accel = [sum(a * np.sin(2 * np.pi * f * t + p) for f, a, p in one) for one in motions]
    speed = [
        sum(-a * np.cos(2 * np.pi * f * t + p) / (2 * np.pi * f) for f, a, p in one)
        for one in motions
    ]
    return np.array(accel), np.array(speed)


def run(values: np.ndarray) -> Modelled:
    """values: as SOUGHT, in their units."""
    of_damper, of_mount = dampers()
    accel, speed = base(tones(values))
    rig, out = np.ascontiguousarray(values[:RIG_SIZE]), np.zeros((3, 3, 3))

    def at(one: np.ndarray) -> ctypes.c_void_p:
        return one.ctypes.data_as(ctypes.c_void_p)

    library().two_masses_run(
        at(rig), at(of_damper), at(of_mount), at(accel), at(speed),
        ctypes.c_long(accel.shape[1]), ctypes.c_long(round(FROM_s / STEP_s)),
        ctypes.c_double(STEP_s), ctypes.c_long(HOLD), at(out),
    )  # fmt: skip
    return Modelled(*out)


def values_of(x: np.ndarray) -> np.ndarray:
    return np.append(10.0 ** x[:-1], x[-1])


def cost(x: np.ndarray) -> float:
    """The worst ratio of peaks first; a little of all of them, of the ratios of E, and of the
    peaks themselves. A mount that is stretched too far costs more than any of it."""
    found = run(values_of(x))
    if not np.isfinite(found.peak_m_s2).all():
        return 1e3
    apart = np.abs(ratios(found.peak_m_s2) - ratios(PUBLISHED_m_s2))
    e_apart = np.abs(ratios(found.rms_m_s2) - ratios(PUBLISHED_E)).max()
    free = np.abs(np.log(found.peak_m_s2[:, 0] / PUBLISHED_m_s2[:, 0])).max()
    stretched = max(0.0, found.stroke_m.max() - MOST_STROKE_m)
    spread = np.sqrt(np.mean(apart**2))
    return float(apart.max() + 0.1 * spread + 0.02 * (e_apart + free) + 100.0 * stretched)


def search(seed: int, seconds: float, start: np.ndarray | None = None) -> np.ndarray:
    """Differential evolution, from all of SOUGHT or around a start; exponents as SOUGHT."""
    bounds = np.array(list(SOUGHT.values()))
    rng = np.random.default_rng(seed)
    if start is None:
        population = rng.uniform(bounds[:, 0], bounds[:, 1], (POPULATION, len(bounds)))
    else:
        steps = 0.2 * rng.standard_normal((POPULATION, len(bounds)))
        steps[0] = 0.0
        population = np.clip(start + steps, bounds[:, 0], bounds[:, 1])
    end_s = time.monotonic() + seconds
    found = differential_evolution(
        cost, bounds, init=population, seed=seed, maxiter=100_000, polish=False, tol=0.0,
        mutation=(0.4, 0.9), recombination=0.7,
        callback=lambda *_, **__: time.monotonic() > end_s,
    )  # fmt: skip
    return found.x


def told(values: np.ndarray) -> str:
    """Values, tones, and ratios of peaks and E beside the published ones."""
    found = run(values)
    lines = [f"{name} = {value:.4g}" for name, value in zip(SOUGHT, values, strict=True)]
    for f, a, p in tones(values)[2]:
        lines.append(f"  {f:g} Hz: {a:.3g} m/s2, {np.degrees(p):.1f} degrees")
    rows = [
        [name, *(f"{one:.3f}" for one in (*ours, *theirs))]
        for name, ours, theirs in zip(
            ("peaks, 10 Hz", "40 Hz", "not periodic", "E, 10 Hz", "40 Hz", "not periodic"),
            [*ratios(found.peak_m_s2), *ratios(found.rms_m_s2)],
            [*ratios(PUBLISHED_m_s2), *ratios(PUBLISHED_E)],
            strict=True,
        )
    ]
    head = ["ratio to uncontrolled", "damper", "both", "published", "both"]
    return "\n".join([*lines, format_table(head, rows)])


def main(words: Sequence[str]) -> None:
    seed, seconds = int(words[0]), float(words[1]) if len(words) > 1 else 120.0
    print(told(values_of(search(seed, seconds))))


if __name__ == "__main__":
    main(sys.argv[1:] or ["1"])
