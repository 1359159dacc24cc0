"""Networks over the states of hysteresis elements: a black box for any recording, without measured
force at run time; on top of a fitted model (`base`) a grey box.

The elements' times and reaches follow from the motion and the sampling rate. Members differ in
their random start and are averaged. How strongly weights are held down is chosen by leaving out
blocks of the training rows in turn. Model: sim_hil/damper/learned/hysteresis_network.h.
"""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, is_switched, levels_of, records_in
from quiesce.damper.learned.elements import Elements, states_of
from quiesce.damper.learned.model import LearnedDamper, Report, limits_of, silent
from quiesce.damper.library import DamperFile, Scales
from quiesce.damper.model_file import DamperModel
from quiesce.network.dense import Adam, Network, falling_rate

# Rows in which the elements forget that they started at rest are not learned from, at most.
_SETTLING_S = 0.1
# Reaches of the stops, in standard deviations of the displacement.
_REACHES = (0.02, 0.05, 0.1, 0.25, 0.6, 1.5)
_COIL_TIMES_S = (0.003, 0.01, 0.03)
_FIELD_EXPONENT = 1.5
_SATURATIONS = np.geomspace(0.1, 100.0, 61)
_NO_SATURATION = 1e12
# Where two levels tell nothing about it: half the way to saturation at full current.
_USUAL_SATURATION = 1.0


@dataclass(frozen=True)
class Settings:
    hidden: tuple[int, ...] = (48, 24)
    members: int = 6
    epochs: int = 60
    batch: int = 64
    rate: float = 3e-3
    decays: tuple[float, ...] = (0.03, 0.1, 0.3, 1.0)
    folds: int = 3
    search_epochs: int = 25
    clip: float = 6.0
    most_rows: int = 20_000
    base: DamperModel | None = None  # the grey box's; its coil lag is taken over


# Averaged members of a refit that only validates.
_REFIT_MEMBERS = 2

# Of --effort quick, and what stands where time runs out.
BRIEF = Settings(members=2, epochs=15, decays=(0.3,), folds=0)


@dataclass(frozen=True)
class Field:
    """g = s^q (1 + K) / (K + s^q) and its powers 0 .. order."""

    scale_A: float
    order: int
    exponent: float = _FIELD_EXPONENT
    saturation: float = _NO_SATURATION

    def value(self, current_A: np.ndarray) -> np.ndarray:
        toe = np.maximum(current_A / self.scale_A, 0.0) ** self.exponent
        return toe * (1.0 + self.saturation) / (self.saturation + toe)

    def powers(self, current_A: np.ndarray) -> np.ndarray:
        return self.value(current_A)[:, None] ** np.arange(self.order + 1)


@dataclass
class Corrector:
    """One member: a network and a linear part, [heads, features]."""

    network: Network
    skip: np.ndarray

    def heads(self, features: np.ndarray) -> np.ndarray:
        return self.network(features) + features @ self.skip.T


@dataclass(frozen=True)
class Examples:
    """Rows to learn from, in the order of the segments."""

    features: np.ndarray  # [rows, features], scaled and clipped
    powers: np.ndarray  # [rows, heads]
    target: np.ndarray  # [rows], of the largest force, above the base
    blocks: list[tuple[slice, Record]] = field(default_factory=list)

    def rows(self, picked: np.ndarray) -> "Examples":
        return Examples(self.features[picked], self.powers[picked], self.target[picked])


# Elements and field


def elements_for(segments: Sequence[Segment], base: DamperModel | None) -> Elements:
    """Elements for this motion: reaches from its size, times from the sampling rate to its
    slowest swing, coil lags where the command changes within a test."""
    records = records_in(segments)
    rate_Hz = min(record.rate_Hz for record in records)
    disp_m = float(np.std(np.concatenate([record.disp_m for record in records])))
    velocity_m_s = np.concatenate([record.velocity_m_s for record in records])
    least_m = float(np.abs(velocity_m_s).max()) / (6.0 * rate_Hz)
    reach_m = tuple(part * disp_m for part in _REACHES if part * disp_m > least_m)
    swing_s = disp_m / max(float(np.std(velocity_m_s)), 1e-12)
    fast_s = max(1.0 / rate_Hz, 1e-3)
    elastic_s = tuple(np.geomspace(fast_s, max(20.0 * fast_s, 1.5 * swing_s), 4))
    chain_s = (fast_s,) * 4 + tuple(np.geomspace(1.5 * fast_s, max(8.0 * fast_s, 0.015), 6))
    rise_s, fall_s = coil_times(segments, base)
    return Elements(rise_s, fall_s, elastic_s, chain_s, reach_m or (max(disp_m, least_m),))


def coil_times(
    segments: Sequence[Segment], base: DamperModel | None
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Rise and fall; the first is what the base sees."""
    if not is_switched(segments):
        return (), ()
    rise_s, fall_s = _COIL_TIMES_S, _COIL_TIMES_S
    rig: Mapping[str, float] = base.rig if base else {}
    if rig.get("rise_s") or rig.get("fall_s"):
        least_s = 2e-4
        own_rise_s = max(float(rig.get("rise_s", 0.0)), least_s)
        own_fall_s = max(float(rig.get("fall_s", own_rise_s)), least_s)
        rise_s, fall_s = (own_rise_s, *rise_s), (own_fall_s, *fall_s)
    elif base:
        rise_s, fall_s = (2e-4, *rise_s), (2e-4, *fall_s)
    return rise_s, fall_s


def field_for(segments: Sequence[Segment]) -> Field:
    """Without constant levels one head: the coils' states are features. With levels powers of the
    field, whose saturation follows from the sizes of the forces where there are three."""
    most_A = max(float(np.abs(one.record.command).max()) for one in segments)
    scale_A = most_A if most_A > 0.0 else 1.0
    levels = levels_of(segments)
    if is_switched(segments) or len(levels) < 2:
        return Field(scale_A, 0, exponent=1.0)
    if len(levels) < 3:
        return Field(scale_A, 1, saturation=_USUAL_SATURATION)
    return Field(scale_A, 1 if len(levels) < 5 else 2, saturation=saturation_of(segments, scale_A))


def saturation_of(segments: Sequence[Segment], scale_A: float) -> float:
    """K with which root mean square forces lie best on a line over g."""
    levels = np.array([abs(float(np.median(one.record.command))) for one in segments])
    sizes = np.array([np.sqrt(np.mean(one.record.force_N[one.rows] ** 2)) for one in segments])
    named = np.unique(np.round(levels, 6))
    means = np.array([sizes[np.abs(levels - level) < 1e-5].mean() for level in named])
    best = (np.inf, _NO_SATURATION)
    for saturation in _SATURATIONS:
        g = Field(scale_A, 1, saturation=float(saturation)).value(named)
        line = np.stack([np.ones_like(g), g], axis=1)
        rest = means - line @ np.linalg.lstsq(line, means, rcond=None)[0]
        best = min(best, (float(rest @ rest), float(saturation)))
    return best[1]


# Features


def raw_features(record: Record, states: np.ndarray, base_N: np.ndarray | None) -> np.ndarray:
    """In the order of the C++ library, SI: [samples, features]."""
    motion = [record.disp_m, record.velocity_m_s, record.accel_m_s2]
    parts = [np.stack(motion, axis=1), states]
    if base_N is not None:
        parts.append(base_N[:, None])
    return np.concatenate(parts, axis=1)


def base_file(base: DamperModel) -> DamperFile:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "base.toml"
        file.write_text(base.to_toml(), encoding="utf-8")
        return DamperFile(file)


def base_force(base: DamperFile, record: Record, seen_A: np.ndarray) -> np.ndarray:
    lagged = replace(record, command=seen_A)
    return base.simulate(library.motion(lagged), base.substeps(lagged))


@dataclass(frozen=True)
class Prepared:
    """A data set as features, and how they are scaled."""

    examples: Examples
    means: np.ndarray
    scales: np.ndarray


def prepare(
    segments: Sequence[Segment],
    elements: Elements,
    field_law: Field,
    scales: Scales,
    settings: Settings,
) -> Prepared:
    states = states_of(elements, records_in(segments), limits_of(scales)["speed_m_s"])
    base = base_file(settings.base) if settings.base else None
    features, powers, targets, blocks = [], [], [], []
    at = 0
    for one in segments:
        record = one.record
        own = states[id(record)]
        seen_A = own[:, 0] if elements.coil_rise_s else record.command
        base_N = base_force(base, record, seen_A) if base else None
        first = max(one.first, min(int(_SETTLING_S * record.rate_Hz), one.end // 10))
        rows = slice(first, one.end)
        features.append(raw_features(record, own, base_N)[rows])
        powers.append(field_law.powers(seen_A[rows]))
        above = record.force_N if base_N is None else record.force_N - record.averaged(base_N)
        targets.append(above[rows] / scales.force_N)
        blocks.append((slice(at, at + one.end - first), record))
        at += one.end - first
    raw = np.concatenate(features)
    means = raw.mean(axis=0)
    sizes = np.maximum(raw.std(axis=0), 1e-9 * np.abs(raw).max(axis=0) + 1e-12)
    scaled = np.clip((raw - means) / sizes, -settings.clip, settings.clip)
    examples = Examples(scaled, np.concatenate(powers), np.concatenate(targets), blocks)
    return Prepared(examples, means, sizes)


# Training


def train_member(
    examples: Examples, decay: float, epochs: int, settings: Settings, rng: np.random.Generator
) -> Corrector:
    features, powers = examples.features, examples.powers
    heads = powers.shape[1]
    network = Network.random((features.shape[1], *settings.hidden, heads), rng)
    network.biases[-1][0] = examples.target.mean()
    member = Corrector(network, np.zeros((heads, features.shape[1])))
    adam = Adam([*network.values, member.skip], decay)
    every = max(1, len(features) // settings.most_rows)
    picked = np.arange(0, len(features), every)
    batches = max(1, len(picked) // settings.batch)
    for epoch in range(epochs):
        target = sharpened(member, examples) if 4 * epoch >= epochs else examples.target
        order = rng.permutation(picked)
        for k in range(batches):
            rows = order[k * settings.batch : (k + 1) * settings.batch]
            layers = network.forward(features[rows])
            out = layers[-1] + features[rows] @ member.skip.T
            error = np.sum(out * powers[rows], axis=1) - target[rows]
            by_heads = error[:, None] * powers[rows] / len(rows)
            gradients, _ = network.backward(layers, by_heads)
            step = falling_rate(settings.rate, (epoch + k / batches) / epochs)
            adam.step([*gradients, by_heads.T @ features[rows]], step)
    return member


def sharpened(member: Corrector, examples: Examples) -> np.ndarray:
    """Targets for a force that is only then averaged as the file's was: what is measured, and what
    the average takes away from the member's own force."""
    if all(record.average_samples == 1 for _, record in examples.blocks):
        return examples.target
    force = np.sum(member.heads(examples.features) * examples.powers, axis=1)
    target = examples.target.copy()
    for rows, record in examples.blocks:
        target[rows] += force[rows] - record.averaged(force[rows])
    return target


def error_on(member: Corrector, examples: Examples) -> float:
    force = np.sum(member.heads(examples.features) * examples.powers, axis=1)
    return float(np.mean((force - examples.target) ** 2))


def chosen_decay(examples: Examples, settings: Settings, seed: int, progress: Report) -> float:
    """The decay with the least error on contiguous blocks left out in turn."""
    if len(settings.decays) == 1 or settings.folds < 2:
        return settings.decays[0]
    every = max(1, len(examples.target) * 2 // settings.most_rows)
    thinned = examples.rows(np.arange(0, len(examples.target), every))
    count = len(thinned.target)
    fold_of = np.arange(count) * 2 * settings.folds // count % settings.folds
    best = (np.inf, settings.decays[0])
    for decay in settings.decays:
        error = 0.0
        for fold in range(settings.folds):
            rng = np.random.default_rng([seed, fold])
            rest = thinned.rows(np.flatnonzero(fold_of != fold))
            member = train_member(rest, decay, settings.search_epochs, settings, rng)
            error += error_on(member, thinned.rows(np.flatnonzero(fold_of == fold)))
        error = float(np.sqrt(error / settings.folds))
        progress(f"hysteresis_network: decay {decay:g}: error {error:.4g} on rows left out")
        best = min(best, (error, decay))
    return best[1]


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    progress: Report = silent,
) -> LearnedDamper:
    settings = settings or Settings()
    if len({one.record.command_unit for one in segments}) > 1:
        raise UsageError("some tests command a current and some a voltage; train on one kind")
    elements = elements_for(segments, settings.base)
    field_law = field_for(segments)
    prepared = prepare(segments, elements, field_law, scales, settings)
    decay = chosen_decay(prepared.examples, settings, seed, progress)
    members = []
    for k in range(settings.members):
        rng = np.random.default_rng([seed, 1000 + k])
        members.append(train_member(prepared.examples, decay, settings.epochs, settings, rng))
        progress(f"hysteresis_network: member {k + 1} of {settings.members}")
    parameters = parameters_of(prepared, elements, field_law, members, scales.force_N, settings)
    count = sum(one.network.parameter_count for one in members) + members[0].skip.size
    return LearnedDamper(
        "hysteresis_network",
        **limits_of(scales),
        parameters=parameters,
        parameter_count=count,
        notes=(
            f"{len(members)} networks over {prepared.examples.features.shape[1]} features, weight "
            f"decay {decay:g} by blocks left out",
        ),
        settled={
            "decays": (decay,),
            "members": min(settings.members, _REFIT_MEMBERS),
        },
    )


def parameters_of(
    prepared: Prepared,
    elements: Elements,
    field_law: Field,
    members: Sequence[Corrector],
    force_N: float,
    settings: Settings,
) -> dict[str, Any]:
    skip = np.mean([one.skip for one in members], axis=0)
    out: dict[str, Any] = {
        "force_scale_N": float(force_N),
        "current_scale_A": float(field_law.scale_A),
        "field_order": field_law.order,
        "field_exponent": float(field_law.exponent),
        "saturation": float(field_law.saturation),
        "uses_accel": True,
        **elements.tables(),
        "feature_means": prepared.means.tolist(),
        "feature_scales": prepared.scales.tolist(),
        "clip": float(settings.clip),
        "skip": skip.ravel().tolist(),
        "member": [{"layer": one.network.tables()} for one in members],
    }
    if settings.base:
        out["base"] = base_section(settings.base)
    return out


def base_section(base: DamperModel) -> dict[str, Any]:
    return {
        "model": base.model,
        "stroke_m": base.stroke_m,
        "speed_m_s": base.speed_m_s,
        "parameters": dict(base.parameters),
        **({"field": base.field_table} if base.field_table else {}),
    }
