"""Random fuzzy systems for tests: all shapes, norms, hedges and methods."""

from collections.abc import Sequence

import numpy as np
from quiesce.rules.formats.shapes import FLL_SHAPES
from quiesce.rules.model import AND, OR, membership_of
from quiesce.rules.system.model import (
    BISECTOR,
    BY_RULE,
    BY_TERM,
    CENTROID,
    WEIGHTED,
    Block,
    Complement,
    Conclusion,
    ConstantTerm,
    Curve,
    Join,
    LinearTerm,
    Origin,
    Proposition,
    SetTerm,
    System,
    SystemInput,
    SystemOutput,
    SystemRule,
)
from quiesce.rules.system.norms import HEDGES, S_NORMS, T_NORMS, UNBOUNDED_SUM

CONTINUOUS = [name for name in (*T_NORMS, *S_NORMS) if not name.startswith(("Drastic", "Nilp"))]


def random_curve(rng: np.random.Generator, low: float, high: float) -> Curve:
    """Of any of FuzzyLite's shapes."""
    span = high - low
    centre, width = rng.uniform(low, high), rng.uniform(0.1, 0.5) * span
    sorted_four = np.sort(rng.uniform(low - 0.2 * span, high + 0.2 * span, 4)).tolist()
    parameters = {
        "Triangle": sorted_four[:3], "Trapezoid": sorted_four, "Rectangle": sorted_four[:2],
        "Ramp": sorted_four[:2], "Binary": [centre, np.inf], "Arc": [centre, centre + width],
        "SemiEllipse": [centre - width, centre + width], "Gaussian": [centre, 0.5 * width],
        "GaussianProduct": [sorted_four[1], 0.5 * width, sorted_four[2], width],
        "Bell": [centre, width, rng.uniform(1, 4)], "Sigmoid": [centre, 10.0 / span],
        "SigmoidDifference": [sorted_four[0], 20 / span, 15 / span, sorted_four[3]],
        "SigmoidProduct": [sorted_four[0], 20 / span, -15 / span, sorted_four[3]],
        "SShape": sorted_four[:2], "ZShape": sorted_four[2:], "PiShape": sorted_four,
        "Cosine": [centre, 2 * width], "Spike": [centre, width],
        "Concave": [centre, centre + width],
    }  # fmt: skip
    word = str(rng.choice(list(FLL_SHAPES)))
    shape, values = FLL_SHAPES[word], parameters[word]
    made, origin = shape(values), Origin(shape.make, tuple(shape.ordered(values)))
    if callable(made):
        return Curve(word, made, None, shape.knots(*shape.ordered(values)), origin)
    points = tuple(made)
    return Curve(word, lambda x: membership_of(points, x), points, (), origin)


def random_expression(
    rng: np.random.Generator, terms: list[int], hedge_words: Sequence[str], depth: int = 0
):
    if depth == 2 or rng.random() < 0.4:
        variable = int(rng.integers(len(terms)))
        hedges = tuple(rng.choice(list(hedge_words), rng.integers(0, 3)).tolist())
        return Proposition(True, variable, int(rng.integers(terms[variable])), hedges)
    parts = tuple(
        random_expression(rng, terms, hedge_words, depth + 1)
        for _ in range(int(rng.integers(2, 4)))
    )
    joined = Join(str(rng.choice([AND, OR])), parts)
    return Complement(joined) if rng.random() < 0.2 else joined


def random_output(rng: np.random.Generator, number: int, inputs: int) -> SystemOutput:
    method = str(rng.choice([BY_RULE, BY_TERM, WEIGHTED, CENTROID, BISECTOR]))
    low, high = -float(rng.uniform(0, 5)), float(rng.uniform(1, 5))
    name, count = f"out{number}", int(rng.integers(2, 5))
    s_norm = str(rng.choice([one for one in S_NORMS if one in CONTINUOUS]))
    if method in (CENTROID, BISECTOR):
        sets = tuple(SetTerm(f"s{k}", random_curve(rng, low, high)) for k in range(count))
        return SystemOutput(name, low, high, sets, method, s_norm, 64, 0.0)
    terms = tuple(
        LinearTerm(f"l{k}", tuple(rng.uniform(-1, 1, inputs).tolist()), 0.5)
        if k % 2
        else ConstantTerm(f"c{k}", float(rng.uniform(low, high)))
        for k in range(count)
    )
    norm = UNBOUNDED_SUM if method != BY_TERM else s_norm
    return SystemOutput(name, low, high, terms, method, norm, 0, 0.0, bool(rng.random() < 0.3))


def random_system(
    number: int, any_norm: bool = False, hedge_words: Sequence[str] = tuple(HEDGES)
) -> System:
    """any_norm: also drastic and nilpotent ones, which jump."""
    rng = np.random.default_rng([51, number])
    inputs = []
    for i in range(int(rng.integers(1, 4))):
        low = float(rng.uniform(-10, 10))
        high = low + float(rng.uniform(0.5, 20))
        sets = tuple(
            SetTerm(f"t{k}", random_curve(rng, low, high)) for k in range(rng.integers(2, 5))
        )
        inputs.append(SystemInput(f"in{i}", low, high, sets))
    outputs = tuple(random_output(rng, k, len(inputs)) for k in range(int(rng.integers(1, 3))))
    t_norms = [one for one in T_NORMS if any_norm or one in CONTINUOUS]
    s_norms = [one for one in S_NORMS if (any_norm or one in CONTINUOUS) and one != UNBOUNDED_SUM]
    blocks = tuple(
        Block(*(str(rng.choice(norms)) for norms in (t_norms, s_norms, t_norms)))
        for _ in range(int(rng.integers(1, 3)))
    )
    rules = tuple(
        SystemRule(
            block,
            random_expression(rng, [len(one.terms) for one in inputs], hedge_words),
            tuple(
                Conclusion(k, int(rng.integers(len(one.terms))), ("very",) * int(rng.integers(2)))
                for k, one in enumerate(outputs)
            ),
            float(rng.choice([1.0, 0.5])),
        )
        for block in range(len(blocks))
        for _ in range(int(rng.integers(2, 7)))
    )
    return System(f"random {number}", tuple(inputs), outputs, blocks, rules)
