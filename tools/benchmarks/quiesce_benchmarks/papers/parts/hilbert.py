"""Review of MR dampers, eq 34: a network over envelope, instantaneous frequency and phase.

The same network (taps, layers, rows, seed) over displacement, velocity and current alone ("plain"),
with the features of the FFT's Hilbert transform over the whole record ("published", which sees the
future) and with our causal ones ("causal", what damper files run). Trained on sines of several
amplitudes and frequencies and on random motions of two dampers with hysteresis, 1 % noise on the
force; judged on motions and currents that no training had: another sine, another random motion, and
three kinds of their own. Errors are ||F - F_model|| / ||F||, running free, both dampers alike. The
review prints no number.
"""

from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from quiesce.base.paths import default_plant
from quiesce.base.table import format_table
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.example import EXAMPLE
from quiesce.damper.excitation import random_motion, sweep, switched_current, times
from quiesce.damper.inverses.excited import (
    NOISE_PART,
    MOTION_Hz,
    RATE_Hz,
    excited,
    moved,
    swinging_A,
)
from quiesce.damper.learned.hilbert import Quadrature, Settings, fitted
from quiesce.damper.library import Scales
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.damper.score import score
from quiesce.damper.simulate import simulator

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.seeds import generator

TITLE = "network over envelope, frequency and phase (review, eq 34)"
FORMS = ("plain", "published", "causal")
FIGURE = "hilbert_model_error_pct"
FIGURES = tuple((f"{FIGURE}_{form}", "%", None, "lower") for form in FORMS)
DAMPERS = (("spencer_prototype", 2.25), ("example", 1.0))
LAGS = (0, 1, 2, 4, 8)
RUNS = 3  # trainings, each with its own seed and recordings
DURATION_s = 10.0
SINE_s = 4.0
SINE_PARTS = (0.3, 0.65, 1.0)  # of the largest amplitude
SINES_Hz = (0.7, 1.7, 3.5, 6.0)


@dataclass(frozen=True)
class Truth:
    damper: DamperModel
    most_A: float


def truths() -> list[Truth]:
    folder = default_plant().parent.parent / "dampers"
    return [
        Truth(EXAMPLE if name == "example" else read_model(folder / f"{name}.toml"), most_A)
        for name, most_A in DAMPERS
    ]


def sine(time_s: np.ndarray, damper: DamperModel, part: float, freq_Hz: float) -> np.ndarray:
    """`part` of the amplitude that stroke and speed allow."""
    reach_m, speed_m_s = 0.5 * damper.stroke_m, 0.8 * damper.speed_m_s
    size_m = part * min(reach_m, speed_m_s / (2.0 * np.pi * freq_Hz))
    return size_m * np.sin(2.0 * np.pi * freq_Hz * time_s)


def sines(truth: Truth, seed: int) -> list[Segment]:
    """For training: amplitudes and frequencies in turn, the current in steps or swinging."""
    time_s = times(SINE_s, RATE_Hz)
    simulate = simulator(truth.damper)
    levels = [float(level) for level in np.linspace(0.0, truth.most_A, 9)]
    rng = np.random.default_rng(seed)
    out = []
    for k, (part, freq_Hz) in enumerate(product(SINE_PARTS, SINES_Hz)):
        disp_m = sine(time_s, truth.damper, part, freq_Hz)
        own = int(rng.integers(1 << 31))
        current_A = (
            switched_current(time_s, levels, own)
            if k % 2
            else swinging_A(time_s, truth.most_A, own)
        )
        record = moved(f"sine {freq_Hz:g} Hz", time_s, disp_m, current_A)
        force_N = simulate(record)
        noise_N = NOISE_PART * float(np.std(force_N)) * rng.standard_normal(len(record))
        out.append(whole(replace(record, force_N=force_N + noise_N)))
    return out


def held_out(truth: Truth, seed: int) -> list[Segment]:
    time_s = times(DURATION_s, RATE_Hz)
    damper = truth.damper
    reach_m, speed_m_s = 0.5 * damper.stroke_m, 0.8 * damper.speed_m_s
    swell = 0.55 - 0.45 * np.cos(2.0 * np.pi * 0.3 * time_s)
    # Between two amplitudes within a fifth of a second.
    stepped = 0.675 + 0.325 * np.tanh(12.0 * np.sin(2.0 * np.pi * 0.385 * time_s))
    motions = {
        "sine of another frequency": sine(time_s, damper, 0.6, 2.9),
        "random motion": random_motion(time_s, reach_m, speed_m_s, MOTION_Hz, seed + 1),
        "swelling sine": sine(time_s, damper, 0.8, 2.2) * swell,
        "sweep": sweep(time_s, 0.8 * reach_m, 0.8 * speed_m_s, 0.7, 6.0),
        "steps of amplitude": sine(time_s, damper, 0.8, 4.0) * stepped,
    }
    current_A = swinging_A(time_s, truth.most_A, seed)
    simulate = simulator(damper)
    out = []
    for name, disp_m in motions.items():
        record = moved(name, time_s, disp_m, current_A)
        out.append(whole(replace(record, force_N=simulate(record))))
    return out


def errors_of(truth: Truth, seed: int, is_quick: bool) -> dict[str, dict[str, float]]:
    """By form: of all ("all") and of each test, in percent."""
    simulate = simulator(truth.damper)
    train = excited(truth.damper, simulate, truth.most_A, seed, 2) + sines(truth, seed)
    test = held_out(truth, seed)
    scales = Scales.of(train)
    settings = Settings(lags=LAGS, epochs=30 if is_quick else 60)
    quadrature = Quadrature.of(train, scales, 1.0 / RATE_Hz, settings.periods)
    features = {
        "plain": None, "published": quadrature.published, "causal": quadrature.features
    }  # fmt: skip
    out = {}
    for form in FORMS:
        model = fitted(train, scales, seed, settings, 1.0 / RATE_Hz, features[form])
        found = score(model.simulate, test)
        out[form] = {one.name: 100.0 * one.error for one in found.segments}
        out[form]["all"] = 100.0 * found.error
    return out


def measure(effort: Effort) -> Measured:
    reported: dict[str, Any] = {}
    rng = generator(effort.seed, "hilbert")
    seeds = [int(one) for one in rng.integers(1 << 30, size=1 if effort.is_quick else RUNS)]
    for truth in truths():
        runs = [errors_of(truth, seed, effort.is_quick) for seed in seeds]
        reported[truth.damper.name] = {
            form: {
                name: float(np.mean([run[form][name] for run in runs])) for name in runs[0][form]
            }
            for form in FORMS
        }
    values = {
        f"{FIGURE}_{form}": float(np.mean([one[form]["all"] for one in reported.values()]))
        for form in FORMS
    }
    tables = [table_of(name, found) for name, found in reported.items()]
    return Measured(values, reported, tuple(tables))


def table_of(name: str, found: dict[str, dict[str, float]]) -> str:
    rows = [[test, *(f"{found[form][test]:.1f}" for form in FORMS)] for test in found[FORMS[0]]]
    return f"Model error, %, {name}\n{format_table(['test', *FORMS], rows, left=(0,))}"
