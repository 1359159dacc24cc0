"""Self-tuning fuzzy model of a damper: trained while it runs, by error backpropagation.

  F = force_scale k(i) u(x, v),  u = sum_r mu_r w_r / sum_r mu_r over 25 rules

On line (SelfTuning.update) it needs the measured force after every sample: it is then an adaptive
estimator, not a prediction. `train` runs it over the data a few times and freezes it: what comes
out is a forward model, to be judged free-running. Source: STF model of the RD-1005-3 damper, with
its gradients completed: force_scale, the other antecedent's grade, and sums over all rules that
share a membership or an output.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from quiesce.damper.data.split import Segment
from quiesce.damper.learned.model import LearnedDamper, Report, limits_of, positive, silent
from quiesce.damper.library import Scales

LABELS = 5
NB, NS, ZE, PS, PB = range(LABELS)
# Rows displacement, columns velocity, both NB .. PB.
RULES = np.array(
    [
        [NB, NB, NS, ZE, PB],
        [NB, NS, NS, PS, PB],
        [NB, NS, ZE, PS, PB],
        [NB, NS, PS, PS, PB],
        [NB, ZE, PS, PB, PB],
    ]
)
_FLAT_RULES = RULES.ravel()
LEAST_WEIGHT = 1e-6

# What updates may not do: memberships keep apart, overlap and stay near the inputs' range.
_LEAST_GAP = 0.05
_OVERLAP = 1.1
_MOST_BASE = 3.0
_MOST_CENTRE = 1.2
_MOST_OUTPUT = 3.0
# Below it even steps are no larger.
_LEAST_GAIN = 0.02


@dataclass
class Rates:
    """Of outputs, centres and bases, for errors in parts of force_scale. is_even: steps are divided
    by the square of the current's gain, so that small forces are learned as fast as large ones.
    most_move: of a centre or a base in one sample; a large error otherwise throws the memberships
    into a heap, from which they take seconds to part."""

    output: float = 0.1
    centre: float = 0.01
    base: float = 0.01
    is_even: bool = False
    most_move: float = np.inf


@dataclass(frozen=True)
class Settings:
    cycles: int = 15  # over the training data
    most_rows: int = 2500  # of a cycle
    rates: Rates = field(default_factory=Rates)
    conjunction: str = "product"  # or "minimum"


# Of --effort quick, and what stands where time runs out.
BRIEF = Settings(cycles=3)


@dataclass
class Triangles:
    """mu = max(0, 1 - 2 |value - centre| / base)."""

    centres: np.ndarray
    bases: np.ndarray

    @staticmethod
    def even(low: float, high: float) -> "Triangles":
        """Neighbours cross at one half."""
        centres = np.linspace(low, high, LABELS)
        return Triangles(centres, np.full(LABELS, 2.0 * (centres[1] - centres[0])))

    def grades(self, value: float) -> np.ndarray:
        return np.maximum(0.0, 1.0 - 2.0 * np.abs(value - self.centres) / self.bases)

    def slopes(self, value: float) -> tuple[np.ndarray, np.ndarray]:
        """d mu / d centre and d mu / d base; 0 outside of the support."""
        distance = value - self.centres
        inside = 2.0 * np.abs(distance) < self.bases
        return (
            np.where(inside, 2.0 * np.sign(distance) / self.bases, 0.0),
            np.where(inside, 2.0 * np.abs(distance) / self.bases**2, 0.0),
        )

    def guard(self) -> None:
        """Centres in order and apart, each base wide enough to reach its neighbours and the ends
        of -1 .. 1: some membership holds everywhere."""
        centres = self.centres.tolist()
        least = -_MOST_CENTRE
        for k, centre in enumerate(centres):
            most = _MOST_CENTRE - _LEAST_GAP * (LABELS - 1 - k)
            centres[k] = min(max(centre, least), most)
            least = centres[k] + _LEAST_GAP
        # To the neighbours; the outermost as far again as to the ends.
        gaps = [
            2.0 * (centres[0] + 1.0),
            *(after - before for before, after in pairwise(centres)),
            2.0 * (1.0 - centres[-1]),
        ]
        bases = [
            max(min(base, _MOST_BASE), _OVERLAP * max(gaps[k], gaps[k + 1]), _LEAST_GAP)
            for k, base in enumerate(self.bases.tolist())
        ]
        self.centres[:], self.bases[:] = centres, bases


@dataclass(frozen=True)
class Gradients:
    """Of u."""

    outputs: np.ndarray
    centres: tuple[np.ndarray, np.ndarray]  # displacement, velocity
    bases: tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class _Graded:
    """A sample's way forward: inputs, their grades, the sum of the rules' heights, of that each
    label's share, and u."""

    x: float
    v: float
    by_x: np.ndarray
    by_v: np.ndarray
    total: float
    shares: np.ndarray
    u: float


@dataclass
class SelfTuning:
    """Inputs: displacement and velocity in parts of their scales, cut off at +-1, the current in
    parts of its scale, cut off at 0 and 1."""

    force_scale_N: float
    disp_scale_m: float
    velocity_scale_m_s: float
    current_scale_A: float
    gains: np.ndarray  # of the current's five labels
    uses_minimum: bool = False
    disp: Triangles = field(default_factory=lambda: Triangles.even(-1.0, 1.0))
    velocity: Triangles = field(default_factory=lambda: Triangles.even(-1.0, 1.0))
    current: Triangles = field(default_factory=lambda: Triangles.even(0.0, 1.0))
    outputs: np.ndarray = field(default_factory=lambda: np.array([-1.0, -0.7, 0.0, 0.7, 1.0]))

    def __post_init__(self) -> None:
        self.gains = np.array(self.gains, dtype=float)
        positive(self.force_scale_N, "force")
        positive(self.disp_scale_m, "displacement")
        positive(self.velocity_scale_m_s, "velocity")
        positive(self.current_scale_A, "scale of the current")

    def gain(self, current_A: float) -> float:
        """k."""
        grades = self.current.grades(min(max(current_A / self.current_scale_A, 0.0), 1.0))
        return float(grades @ self.gains) / max(float(grades.sum()), LEAST_WEIGHT)

    def _graded(self, disp_m: float, velocity_m_s: float) -> "_Graded":
        x = min(max(disp_m / self.disp_scale_m, -1.0), 1.0)
        v = min(max(velocity_m_s / self.velocity_scale_m_s, -1.0), 1.0)
        by_x, by_v = self.disp.grades(x), self.velocity.grades(v)
        if self.uses_minimum:
            heights = np.minimum(by_x[:, None], by_v[None, :])
        else:
            heights = by_x[:, None] * by_v[None, :]
        total = float(heights.sum())
        shares = np.bincount(_FLAT_RULES, heights.ravel(), LABELS) / max(total, LEAST_WEIGHT)
        return _Graded(x, v, by_x, by_v, total, shares, float(shares @ self.outputs))

    def output(self, disp_m: float, velocity_m_s: float) -> float:
        """u."""
        return self._graded(disp_m, velocity_m_s).u

    def force_N(self, disp_m: float, velocity_m_s: float, current_A: float) -> float:
        return self.force_scale_N * self.gain(current_A) * self.output(disp_m, velocity_m_s)

    def gradients(self, disp_m: float, velocity_m_s: float) -> Gradients:
        """Of u. With the minimum only the smaller grade of a rule passes its gradient on."""
        return self._gradients(self._graded(disp_m, velocity_m_s))

    def _gradients(self, at: "_Graded") -> Gradients:
        base = at.u if at.total >= LEAST_WEIGHT else 0.0
        by_height = (self.outputs - base)[RULES] / max(at.total, LEAST_WEIGHT)
        if self.uses_minimum:
            to_x = (by_height * (at.by_x[:, None] <= at.by_v[None, :])).sum(axis=1)
            to_v = (by_height * (at.by_v[None, :] < at.by_x[:, None])).sum(axis=0)
        else:
            to_x, to_v = by_height @ at.by_v, at.by_x @ by_height
        x_slopes, v_slopes = self.disp.slopes(at.x), self.velocity.slopes(at.v)
        return Gradients(
            at.shares,
            (to_x * x_slopes[0], to_v * v_slopes[0]),
            (to_x * x_slopes[1], to_v * v_slopes[1]),
        )

    def update(
        self, disp_m: float, velocity_m_s: float, current_A: float, measured_N: float, rates: Rates
    ) -> float:
        """One sample on line: the force before the update, in N."""
        at = self._graded(disp_m, velocity_m_s)
        k = self.gain(current_A)
        force_N = self.force_scale_N * k * at.u
        step = k * (force_N - measured_N) / self.force_scale_N
        if rates.is_even:
            step /= max(k, _LEAST_GAIN) ** 2
        gradients = self._gradients(at)
        most = _MOST_OUTPUT
        self.outputs[:] = np.minimum(
            np.maximum(self.outputs - rates.output * step * gradients.outputs, -most), most
        )
        for k_input, triangles in enumerate((self.disp, self.velocity)):
            for values, rate, gradient in (
                (triangles.centres, rates.centre, gradients.centres[k_input]),
                (triangles.bases, rates.base, gradients.bases[k_input]),
            ):
                move = rate * step * gradient
                values -= np.minimum(np.maximum(move, -rates.most_move), rates.most_move)
            triangles.guard()
        return force_N

    def parameters(self) -> dict[str, Any]:
        """The frozen model's [parameters]."""
        sets = {"displacement": self.disp, "velocity": self.velocity, "current": self.current}
        return {
            "force_scale_N": float(self.force_scale_N),
            "disp_scale_m": float(self.disp_scale_m),
            "velocity_scale_m_s": float(self.velocity_scale_m_s),
            "current_scale_A": float(self.current_scale_A),
            "conjunction": "minimum" if self.uses_minimum else "product",
            "outputs": self.outputs.tolist(),
            "gains": self.gains.tolist(),
            "rules": RULES.ravel().tolist(),
            **{
                name: {"centres": one.centres.tolist(), "bases": one.bases.tolist()}
                for name, one in sets.items()
            },
        }


def scheduled_gains(
    current_A: np.ndarray, force_N: np.ndarray, scale_A: float, force_scale_N: float
) -> np.ndarray:
    """Gains of the five labels from the sizes of the forces at the currents that there are:
    straight lines between them, so that the largest force has a gain of about 1."""
    levels = np.round(current_A / scale_A, 2)
    named = np.unique(levels)
    sizes = np.array([np.quantile(np.abs(force_N[levels == one]), 0.98) for one in named])
    counts = np.array([np.sum(levels == one) for one in named])
    kept = counts >= 0.02 * counts.max()
    nodes = np.linspace(0.0, 1.0, LABELS)
    return np.interp(nodes, named[kept], sizes[kept]) / force_scale_N


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    progress: Report = silent,
) -> LearnedDamper:
    """Frozen after the last cycle. The seed is not used: samples come in the order of time."""
    settings = settings or Settings()
    disp_m, velocity_m_s, current_A, force_N = (
        np.concatenate([getattr(one.record, name)[one.rows] for one in segments])
        for name in ("disp_m", "velocity_m_s", "command", "force_N")
    )
    scale_A = max(float(current_A.max()), 1e-9)
    gains = scheduled_gains(current_A, force_N, scale_A, scales.force_N)
    model = SelfTuning(
        scales.force_N, scales.disp_m, scales.speed_m_s, scale_A, gains,
        settings.conjunction == "minimum",
    )  # fmt: skip
    every = max(1, len(force_N) // settings.most_rows)
    errors: list[float] = []
    for cycle in range(settings.cycles):
        before = [
            model.update(disp_m[k], velocity_m_s[k], current_A[k], force_N[k], settings.rates)
            for k in range(cycle % every, len(force_N), every)
        ]
        rest = np.array(before) - force_N[cycle % every :: every]
        errors.append(float(np.sqrt(np.mean(rest**2))))
        progress(f"neuro_fuzzy_stf: cycle {cycle + 1}, {errors[-1]:.4g} N while adapting")
    return LearnedDamper(
        "neuro_fuzzy_stf",
        **limits_of(scales),
        parameters=model.parameters(),
        parameter_count=LABELS * 6,
        notes=(
            f"root mean square while adapting {errors[0]:.4g} N in the first cycle, "
            f"{errors[-1]:.4g} N in the last; frozen then",
        ),
    )
