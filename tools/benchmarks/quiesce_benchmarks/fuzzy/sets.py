"""Random membership functions: for inputs in several layouts, for outputs in ascending order."""

import numpy as np
from quiesce.rules.model import FuzzySet, ramp, trapezoid

# How the sets of an input lie: their memberships add up to 1; at most two overlap; any number does;
# none fires in between; vertical edges; open ends and ramps that cross.
PARTITION, PAIRS, CROWD, GAPS, RECTANGLES, RAMPS = (
    "partition",
    "pairs",
    "crowd",
    "gaps",
    "rectangles",
    "ramps",
)
LAYOUTS = (PARTITION, PAIRS, CROWD, GAPS, RECTANGLES, RAMPS)

# Neighbouring cuts are at least this share of the universe apart.
LEAST_STEP = 0.01


def cuts(rng: np.random.Generator, count: int, low: float, high: float) -> list[float]:
    """Ascending places inside the universe, sometimes on a decimal grid, sometimes any float."""
    if count == 0:
        return []
    steps = LEAST_STEP + rng.dirichlet(np.full(count + 1, 1.5)) * (1 - LEAST_STEP * (count + 1))
    places = low + (high - low) * np.cumsum(steps)[:-1]
    if rng.random() < 0.5:
        grid = 10.0 ** np.floor(np.log10((high - low) * LEAST_STEP))
        return [float(f"{x:.12g}") for x in np.round(places / grid) * grid]
    return [float(x) for x in places]


def partition(rng: np.random.Generator, count: int, low: float, high: float) -> list[FuzzySet]:
    """Each falls where the next one rises; sometimes triangles only."""
    if rng.random() < 0.4:
        tops = [low, *cuts(rng, count - 2, low, high), high]
        edges = list(zip(tops, tops[1:], strict=False))
    else:
        flat = cuts(rng, 2 * (count - 1), low, high)
        edges = list(zip(flat[::2], flat[1::2], strict=True))
    open_ends = (-np.inf, np.inf) if rng.random() < 0.5 else (low, high)
    rises = [(open_ends[0], open_ends[0]), *edges]
    falls = [*edges, (open_ends[1], open_ends[1])]
    return [
        trapezoid(f"s{k}", *rise, *fall)
        for k, (rise, fall) in enumerate(zip(rises, falls, strict=True))
    ]


def pairs(rng: np.random.Generator, count: int, low: float, high: float) -> list[FuzzySet]:
    """Neighbours overlap, their neighbours do not; sums are what they are."""
    flat = cuts(rng, 2 * (count - 1), low, high)
    left = [low, *flat[::2]]
    right = [*flat[1::2], high]
    return [
        trapezoid(f"s{k}", a, *tops(rng, a, d), d)
        for k, (a, d) in enumerate(zip(left, right, strict=True))
    ]


def tops(rng: np.random.Generator, a: float, d: float) -> list[float]:
    """One place or two between a and d, sometimes on one of them."""
    shares = np.sort(rng.choice([*rng.random(2), 0.0, 1.0], 2, p=[0.4, 0.4, 0.1, 0.1]))
    if rng.random() < 0.4:
        shares[:] = rng.random()
    return [float(x) for x in np.clip(a + (d - a) * shares, a, d)]


def crowd(rng: np.random.Generator, count: int, low: float, high: float) -> list[FuzzySet]:
    """Wide, anywhere; three and more overlap."""
    span = high - low
    found = []
    for k in range(count):
        width = span * rng.uniform(0.4, 0.9)
        a = low + rng.uniform(-0.2, 1.2) * (span - width)
        found.append(trapezoid(f"s{k}", float(a), *tops(rng, a, a + width), float(a + width)))
    return found


def gaps(rng: np.random.Generator, count: int, low: float, high: float) -> list[FuzzySet]:
    """None overlaps; between them, and before the first, nothing fires."""
    flat = cuts(rng, 2 * count, low, high)
    return [
        trapezoid(f"s{k}", a, *tops(rng, a, d), d)
        for k, (a, d) in enumerate(zip(flat[::2], flat[1::2], strict=True))
    ]


def rectangles(rng: np.random.Generator, count: int, low: float, high: float) -> list[FuzzySet]:
    """Vertical edges; touching neighbours, or apart."""
    if rng.random() < 0.5:
        edges = [low, *cuts(rng, count - 1, low, high), high]
        ends = list(zip(edges, edges[1:], strict=False))
    else:
        flat = cuts(rng, 2 * count, low, high)
        ends = list(zip(flat[::2], flat[1::2], strict=True))
    return [trapezoid(f"s{k}", a, a, d, d) for k, (a, d) in enumerate(ends)]


def ramps(rng: np.random.Generator, count: int, low: float, high: float) -> list[FuzzySet]:
    """Rising and falling ramps and shoulders, open on one side."""
    found = []
    for k in range(count):
        zero, one = cuts(rng, 2, low, high)
        found.append(ramp(f"s{k}", *((zero, one) if rng.random() < 0.5 else (one, zero))))
    return found


MAKERS = {
    PARTITION: partition,
    PAIRS: pairs,
    CROWD: crowd,
    GAPS: gaps,
    RECTANGLES: rectangles,
    RAMPS: ramps,
}


def input_sets(
    rng: np.random.Generator, layout: str, count: int, low: float, high: float
) -> tuple[FuzzySet, ...]:
    return tuple(MAKERS[layout](rng, count, low, high))


def output_sets(
    rng: np.random.Generator, count: int, low: float, high: float
) -> tuple[FuzzySet, ...]:
    """Feet and tops of each are not left of those of the one before; all have area inside."""
    span = high - low
    reach = 0.15 if rng.random() < 0.3 else 0.0  # some sets stick out of the universe
    middles = np.sort(rng.uniform(low + 0.05 * span, high - 0.05 * span, count))
    corners = middles[:, None] + span * np.sort(rng.uniform(-0.3, 0.3, (count, 4)), axis=1)
    corners = np.clip(corners, low - reach * span, high + reach * span)
    corners[:, 0] = np.minimum(corners[:, 0], middles - 0.02 * span)
    corners[:, 3] = np.maximum(corners[:, 3], middles + 0.02 * span)
    corners = np.sort(np.sort(corners, axis=1), axis=0)
    corners[:, 0] = np.minimum(corners[:, 0], high - 0.02 * span)
    corners[:, 3] = np.maximum(corners[:, 3], low + 0.02 * span)
    kind = rng.choice(["trapezoid", "triangle", "rectangle"], p=[0.5, 0.35, 0.15])
    if kind == "triangle":
        corners[:, 2] = corners[:, 1]
    elif kind == "rectangle":
        corners[:, 1], corners[:, 2] = corners[:, 0], corners[:, 3]
    return tuple(trapezoid(f"t{k}", *map(float, row)) for k, row in enumerate(corners))


def breakpoints(sets: tuple[FuzzySet, ...]) -> list[float]:
    return sorted({x for one in sets for x, _ in one.points})
