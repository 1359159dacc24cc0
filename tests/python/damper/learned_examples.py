"""Learned models of every kind, with random numbers: for tests of what carries them elsewhere."""

from typing import Any

import numpy as np
from quiesce.damper.example import EXAMPLE
from quiesce.damper.model_file import DamperModel

LIMITS = {
    "current_A": {"range": [0.0, 1.0]},
    "displacement_m": {"range": [-0.01, 0.01]},
    "velocity_m_s": {"range": [-0.12, 0.12]},
}


def learned(model: str, parameters: dict[str, Any], **more: Any) -> DamperModel:
    return DamperModel(model, model, 0.02, 0.2, parameters, **more)


def layers(units: list[int], inputs: int, outputs: int = 1, seed: int = 3) -> list[dict[str, Any]]:
    rng = np.random.default_rng(seed)
    out, before = [], inputs
    for count in [*units, outputs]:
        weights = rng.normal(size=count * before) / np.sqrt(before)
        out.append(
            {"units": count, "weights": weights.tolist(), "biases": rng.normal(size=count).tolist()}
        )
        before = count
    return out


def network(units: list[int]) -> DamperModel:
    keys = {**LIMITS, "force_scale_N": 400.0, "layer": layers(units, 3)}
    return learned("feed_forward_network", keys)


def sampled(model: str, lags: list[int], width: int = 3, **more: Any) -> DamperModel:
    """A sample time that no record of the tests has."""
    inputs = len(lags) * width + len(more.get("feedback", []))
    keys = {**LIMITS, "force_scale_N": 400.0, "sample_time_s": 0.0043, "lags": lags, **more}
    return learned(model, keys | {"layer": layers([6, 4], inputs)})


def support_vectors() -> DamperModel:
    rng = np.random.default_rng(4)
    keys = {"force_scale_N": 300.0, "gamma": 0.7, "intercept": 0.1}
    keys |= {"coefficients": rng.normal(size=20).tolist()}
    keys |= {"support_vectors": rng.uniform(-1, 1, 60).tolist()}
    return learned("support_vector", LIMITS | keys)


def clusters() -> DamperModel:
    rng = np.random.default_rng(5)
    rules = [
        {
            "centre": rng.uniform(-1, 1, 3).tolist(),
            "width": rng.uniform(0.2, 0.8, 3).tolist(),
            "gain_N": rng.normal(0.0, 200.0, 3).tolist(),
            "offset_N": float(rng.normal(0.0, 50.0)),
        }
        for _ in range(5)
    ]
    return learned("ts_fuzzy", {**LIMITS, "rule": rules})


def self_tuning(conjunction: str) -> DamperModel:
    centres, bases = [-1.0, -0.5, 0.0, 0.5, 1.0], [1.0, 1.1, 0.9, 1.0, 1.2]
    triangles = {"centres": centres, "bases": bases}
    keys = {
        "force_scale_N": 2000.0,
        "disp_scale_m": 0.009,
        "velocity_scale_m_s": 0.1,
        "current_scale_A": 1.5,
        "conjunction": conjunction,
        "displacement": triangles,
        "velocity": triangles,
        "current": {"centres": [0.0, 0.25, 0.5, 0.75, 1.0], "bases": [0.5] * 5},
        "outputs": [-1.0, -0.7, 0.0, 0.7, 1.0],
        "gains": [0.1, 0.3, 0.5, 0.7, 0.9],
        "rules": [0, 0, 1, 2, 4, 0, 1, 1, 3, 4, 0, 1, 2, 3, 4, 0, 1, 3, 3, 4, 0, 2, 3, 4, 4],
    }
    return learned("neuro_fuzzy_stf", keys)


def hysteresis(has_coil: bool = True, **more: Any) -> DamperModel:
    """Two of each element, and the acceleration where there is no coil."""
    rng = np.random.default_rng(6)
    coil = {"coil_times_s": [0.01, 0.05], "coil_fall_times_s": [0.02, 0.09]}
    features = 2 + 6 + (2 if has_coil else 1) + ("base" in more)
    means = rng.normal(0.0, 1e-3, features)
    sizes = [0.008, 0.1] + ([] if has_coil else [5.0]) + [0.5] * (2 if has_coil else 0)
    sizes += [0.004, 0.004, 0.1, 0.1, 0.7, 0.7] + ([900.0] if "base" in more else [])
    keys = {
        "force_scale_N": 300.0,
        "current_scale_A": 1.0,
        "field_exponent": 1.3,
        "saturation": 4.0,
        "uses_accel": not has_coil,
        **(coil if has_coil else {}),
        "elastic_times_s": [0.02, 0.2],
        "chain_times_s": [0.004, 0.01],
        "stop_reaches_m": [0.0005, 0.003],
        "feature_means": means.tolist(),
        "feature_scales": sizes,
        "clip": 3.0,
        "field_order": 2,
        "skip": rng.normal(0.0, 0.1, 3 * features).tolist(),
        "member": [{"layer": layers([5], features, 3, seed)} for seed in (7, 8)],
    }
    lag = {"rise_s": 0.012, "fall_s": 0.02} if not has_coil else {}
    return learned("hysteresis_network", keys | more, rig=lag)


BASE = {
    "model": EXAMPLE.model,
    "stroke_m": EXAMPLE.stroke_m,
    "speed_m_s": 0.05,
    "parameters": dict(EXAMPLE.parameters),
    "field": {"exponent": 1.4, "saturation": 0.5, "reference_A": 1.0},
}
SWING = {"window_s": 0.2, "envelope_m": 0.009, "lowest_rad_s": 2.0, "highest_rad_s": 60.0}

LEARNED = {
    "linear": network([]),
    "one hidden layer": network([5]),
    "two hidden layers": network([7, 4]),
    "three hidden layers": network([3, 4, 5]),
    "support vectors": support_vectors(),
    "clusters": clusters(),
    "self-tuning, product": self_tuning("product"),
    "self-tuning, minimum": self_tuning("minimum"),
    "delays": sampled("feed_forward_network", [0, 1, 3]),
    "recurrent": sampled("recurrent_network", [0, 2], feedback=[1, 2]),
    "swing": sampled("hilbert_network", [0, 1], width=7, quadrature=SWING),
    "elements": hysteresis(),
    "elements, acceleration": hysteresis(has_coil=False),
    "elements on a model": hysteresis(base=BASE),
}
