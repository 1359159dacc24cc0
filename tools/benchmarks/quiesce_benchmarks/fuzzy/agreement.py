"""One random rule base: the integers against the exact reference, and the peers against it.

The engine may be off by one output LSB from what the reference says anywhere in the box to which
the inputs were rounded. A peer that does not agree with the reference is explained: the reference
is asked again in the peer's own way (sampled, summed), and has to give the peer's answer.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from quiesce.rules.engine.engine import STRAIGHT, TABLE, Engine
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.model import CENTROID, WEIGHTED_MAX, WEIGHTED_SUM, Output, RuleBase
from quiesce.rules.reference import evaluate, membership, term_strengths

from quiesce_benchmarks.fuzzy.points import (
    FINE_BOX_LINES,
    Range,
    integers_of,
    random_points,
    rounding_range,
)
from quiesce_benchmarks.fuzzy.random import RandomBase
from quiesce_benchmarks.fuzzy.sets import breakpoints

# Of an output's universe: two float64 computations of the same thing.
SAME = 1e-9
# libfuzzylite 6 takes numbers for equal that are no further apart: a rule that is not stronger does
# not fire, an input so near to a breakpoint is on it.
FUZZYLITE_TOLERANCE = 1e-6
# Of an output's universe: scikit-fuzzy follows lines between the samples of its universes.
SKFUZZY_SHARE = 1e-4

SAMPLING = "sampled centroid"
SUMMED = "sum where the base says max"
TOLERANCE = f"comparisons with a tolerance of {FUZZYLITE_TOLERANCE:g}"
LINES = "straight lines between samples"
UNEXPLAINED = "unexplained"


@dataclass(frozen=True)
class EngineResult:
    kind: str  # "table" or "straight"
    beyond: int  # points outside the bound
    worst_lsb: float  # distance from the box's range, in output LSB
    worst_at: list[float]


@dataclass
class PeerResult:
    peer: str
    points: int
    worst_share: float = 0.0  # of the output's universe, from the exact reference
    differing: dict[str, int] = field(default_factory=dict)  # points, by what explains them
    refused: str = ""


@dataclass(frozen=True)
class Case:
    """A random base, compiled, with its points and the exact answers [output, point]."""

    random: RandomBase
    compiled: CompiledBase
    points: np.ndarray
    outputs: np.ndarray
    is_default: np.ndarray
    strengths: np.ndarray  # [rule, point]

    @property
    def base(self) -> RuleBase:
        return self.random.base


def make_case(random: RandomBase, seed: int, count: int) -> Case:
    """UsageError where the integers cannot hold the base."""
    compiled = compile_base(random.base)
    rng = np.random.default_rng([seed, random.number, 1])
    points = random_points(random.base, lsb_of(compiled), rng, count)
    exact = evaluate(random.base, list(points.T), want_strengths=True)
    assert exact.strengths is not None
    return Case(random, compiled, points, exact.outputs, exact.is_default, exact.strengths)


def lsb_of(compiled: CompiledBase) -> list[float]:
    return [float(axis.lsb) for axis in compiled.axes]


def excess(
    compiled: CompiledBase, integers: np.ndarray, mask: np.ndarray, allowed: Range
) -> np.ndarray:
    """[point]: how many output LSB the worst output lies outside the box's range.

    Infinite where the default stands and no part of the box has it, or the other way round.
    """
    worst = np.zeros(len(mask))
    for i in range(len(integers)):
        value = compiled.output_value(i, integers[i])
        off = np.maximum(allowed.low[i] - value, value - allowed.high[i]) / compiled.output_lsb(i)
        off = np.where(allowed.has_value[i], np.maximum(off, 0.0), np.inf)
        off_default = np.where(allowed.has_default[i], 0.0, np.inf)
        worst = np.maximum(worst, np.where(mask >> i & 1, off_default, off))
    return worst


def judge_engine(case: Case, kind: str, allowed: Range) -> EngineResult:
    points, compiled = case.points, case.compiled
    integers, mask = Engine(compiled, kind).evaluate(integers_of(compiled, points))
    distance = excess(compiled, integers, mask, allowed)
    # The box again, seen more finely, where it matters.
    beyond = np.flatnonzero(distance > 1.0)
    if len(beyond):
        fine = rounding_range(case.base, points[beyond], lsb_of(compiled), FINE_BOX_LINES)
        distance[beyond] = excess(compiled, integers[:, beyond], mask[beyond], fine)
    worst = int(distance.argmax())
    return EngineResult(
        kind,
        int((distance > 1.0).sum()),
        float(distance[worst]),
        [float(x) for x in points[worst]],
    )


def judge_engines(case: Case, with_straight: bool) -> list[EngineResult]:
    """The table engine, and straight-line C where it is wanted."""
    allowed = rounding_range(case.base, case.points, lsb_of(case.compiled))
    kinds = (TABLE, STRAIGHT) if with_straight else (TABLE,)
    return [judge_engine(case, kind, allowed) for kind in kinds]


def sampled_centroid(output: Output, strengths: np.ndarray, resolution: int) -> np.ndarray:
    """[point] from strengths [term, point]: middles of even steps; NaN where nothing is there."""
    step = (output.maximum - output.minimum) / resolution
    x = output.minimum + (np.arange(resolution) + 0.5) * step
    memberships = np.stack([membership(term, x) for term in output.terms])
    height = np.zeros((strengths.shape[1], resolution))
    for mu, strength in zip(memberships, strengths, strict=True):
        np.maximum(height, np.minimum(mu[None, :], strength[:, None]), out=height)
    with np.errstate(invalid="ignore"):
        return (height * x).sum(axis=1) / height.sum(axis=1)


def in_its_way(case: Case, index: int, resolution: int) -> np.ndarray:
    """The sampled centroid of one output, its default where nothing is sampled; [point]."""
    output = case.base.outputs[index]
    terms = [rule.conclusions[index] for rule in case.base.rules]
    chosen = [i for i, term in enumerate(terms) if term is not None]
    strengths = term_strengths(
        case.strengths[chosen], [terms[i] for i in chosen], len(output.terms)
    )
    sampled = sampled_centroid(output, strengths, resolution)
    return np.where(np.isnan(sampled), output.default, sampled)


def summed(case: Case) -> np.ndarray:
    """[output, point] with every weighted average taken as sum."""
    outputs = tuple(
        replace(one, method=WEIGHTED_SUM) if one.method == WEIGHTED_MAX else one
        for one in case.base.outputs
    )
    return evaluate(replace(case.base, outputs=outputs), list(case.points.T)).outputs


def explain(case: Case, peer: str, found: np.ndarray, resolution: int) -> PeerResult:
    """found [point, output]: what the peer says; explained point by point."""
    result = PeerResult(peer, len(found))
    for i, output in enumerate(case.base.outputs):
        span = output.maximum - output.minimum
        off = np.abs(found[:, i] - case.outputs[i])
        result.worst_share = max(result.worst_share, float(np.nanmax(off) / span))
        open_points = ~(off <= SAME * span)
        for reason, expected in ways(case, i, peer, resolution):
            is_explained = open_points & (np.abs(found[:, i] - expected) <= SAME * span)
            add(result, reason, int(is_explained.sum()))
            open_points &= ~is_explained
        if peer == "libfuzzylite":
            is_close = open_points & is_tolerated(case, i)
            add(result, TOLERANCE, int(is_close.sum()))
            open_points &= ~is_close
        add(result, UNEXPLAINED, int(open_points.sum()))
    return result


def ways(case: Case, index: int, peer: str, resolution: int) -> list[tuple[str, np.ndarray]]:
    """What else the peer may have computed, by reason; [point] each."""
    method = case.base.outputs[index].method
    if method == CENTROID:
        return [(SAMPLING, in_its_way(case, index, resolution))]
    if method == WEIGHTED_MAX and peer == "libfuzzylite":
        return [(SUMMED, summed(case)[index])]
    return []


def is_tolerated(case: Case, index: int) -> np.ndarray:
    """[point]: a rule of the output is so weak, or an input so near to a breakpoint."""
    chosen = [i for i, rule in enumerate(case.base.rules) if rule.conclusions[index] is not None]
    strengths = case.strengths[chosen]
    found = ((strengths > 0) & (strengths <= 2 * FUZZYLITE_TOLERANCE)).any(axis=0)
    for variable, x in zip(case.base.inputs, case.points.T, strict=True):
        places = np.array(breakpoints(variable.sets))
        clamped = np.clip(x, variable.minimum, variable.maximum)
        distance = np.abs(clamped[:, None] - places[None, :]).min(axis=1)
        found |= distance <= 2 * FUZZYLITE_TOLERANCE
    return found


def explain_skfuzzy(case: Case, found: np.ndarray) -> PeerResult:
    """found [point]: what scikit-fuzzy says at the first points; NaN where no rule fires."""
    result = PeerResult("scikit-fuzzy", len(found))
    output = case.base.outputs[0]
    span = output.maximum - output.minimum
    told = np.where(np.isnan(found), output.default, found)
    off = np.abs(told - case.outputs[0, : len(found)])
    result.worst_share = float(off.max() / span)
    is_off = off > SAME * span
    add(result, LINES, int((is_off & (off <= SKFUZZY_SHARE * span)).sum()))
    add(result, UNEXPLAINED, int((off > SKFUZZY_SHARE * span).sum()))
    return result


def add(result: PeerResult, reason: str, count: int) -> None:
    if count:
        result.differing[reason] = result.differing.get(reason, 0) + count
