"""Membership functions by their parameters: straight ones as points, smooth ones as functions."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.rules.model import Point, ramp, trapezoid, triangle

Curve = Callable[[np.ndarray], np.ndarray]  # membership at each x
SHOULDERS = ("Trapezoid", "trapmf", "Binary", "binarymf")  # whose numbers may be infinite
ERROR_STEPS = 20000  # of the universe, at which an approximation's error is taken
GRID_STEPS = 2000  # of the universe, where breakpoints may lie


class ShapeError(Exception):
    """Parameters that make no shape: the message says what is expected."""


def require(ok: bool, expected: str) -> None:
    if not ok:
        raise ShapeError(expected)


def triangle_points(left: float, top: float, right: float) -> tuple[Point, ...]:
    require(left <= top <= right, "parameters that never fall")
    return triangle("", left, top, right).points


def trapezoid_points(a: float, b: float, c: float, d: float) -> tuple[Point, ...]:
    """A shoulder where both ends of a flank are infinite."""
    require(a <= b <= c <= d, "parameters that never fall")
    pairs = math.isinf(a) == math.isinf(b) and math.isinf(c) == math.isinf(d)
    is_somewhere = b < math.inf and c > -math.inf
    require(pairs and is_somewhere, "flanks with two finite ends or two infinite ones")
    return trapezoid("", a, b, c, d).points


def rectangle_points(start: float, end: float) -> tuple[Point, ...]:
    require(start < end, "a start below the end")
    return trapezoid("", start, start, end, end).points


def binary_points(start: float, direction: float) -> tuple[Point, ...]:
    """1 from start on, to infinity or from minus infinity."""
    require(math.isinf(direction), "inf or -inf for its direction")
    edge = ((start, 0.0), (start, 1.0))
    return edge if direction > 0 else edge[::-1]


def ramp_points(zero: float, one: float) -> tuple[Point, ...]:
    require(zero != one, "two different ends")
    return ramp("", zero, one).points


def rising_points(zero: float, one: float) -> tuple[Point, ...]:
    require(zero < one, "a foot below the shoulder")
    return ramp("", zero, one).points


def falling_points(one: float, zero: float) -> tuple[Point, ...]:
    require(one < zero, "a shoulder below the foot")
    return ramp("", zero, one).points


def gaussian(mean: float, deviation: float) -> Curve:
    require(deviation > 0, "a standard deviation above 0")
    return lambda x: np.exp(-0.5 * ((x - mean) / deviation) ** 2)


def two_gaussians(mean_a: float, sd_a: float, mean_b: float, sd_b: float) -> Curve:
    left, right = gaussian(mean_a, sd_a), gaussian(mean_b, sd_b)
    return lambda x: np.where(x < mean_a, left(x), 1.0) * np.where(x > mean_b, right(x), 1.0)


def bell(centre: float, width: float, slope: float) -> Curve:
    require(width > 0 and slope > 0, "a width and a slope above 0")
    return lambda x: 1 / (1 + np.abs((x - centre) / width) ** (2 * slope))


def sigmoid(inflection: float, slope: float) -> Curve:
    return lambda x: 1 / (1 + np.exp(-slope * (x - inflection)))


def sigmoid_difference(left: float, rise: float, fall: float, right: float) -> Curve:
    first, second = sigmoid(left, rise), sigmoid(right, fall)
    return lambda x: np.abs(first(x) - second(x))


def sigmoid_product(left: float, rise: float, fall: float, right: float) -> Curve:
    first, second = sigmoid(left, rise), sigmoid(right, fall)
    return lambda x: first(x) * second(x)


def s_shape(start: float, end: float) -> Curve:
    require(start < end, "a start below the end")

    def curve(x: np.ndarray) -> np.ndarray:
        t = np.clip((x - start) / (end - start), 0.0, 1.0)
        return np.where(t < 0.5, 2 * t**2, 1 - 2 * (1 - t) ** 2)

    return curve


def z_shape(start: float, end: float) -> Curve:
    rising = s_shape(start, end)
    return lambda x: 1 - rising(x)


def pi_shape(foot_a: float, top_a: float, top_b: float, foot_b: float) -> Curve:
    left, right = s_shape(foot_a, top_a), z_shape(top_b, foot_b)
    return lambda x: left(x) * right(x)


def cosine(centre: float, width: float) -> Curve:
    """A raised cosine, 0 from half the width on."""
    require(width > 0, "a width above 0")
    return lambda x: 0.5 + 0.5 * np.cos(2 * np.pi * np.clip((x - centre) / width, -0.5, 0.5))


def spike(centre: float, width: float) -> Curve:
    require(width > 0, "a width above 0")
    return lambda x: np.exp(-np.abs(10 / width * (x - centre)))


def concave(inflection: float, end: float) -> Curve:
    """A hyperbola that reaches 1 at its end."""
    require(inflection != end, "an inflection apart from the end")
    sign, reach = math.copysign(1.0, end - inflection), abs(end - inflection)
    return lambda x: reach / (reach + np.maximum(sign * (end - x), 0.0))


def arc(start: float, end: float) -> Curve:
    """A quarter of a circle, from 0 at its start to 1 at its end."""
    require(start != end, "two different ends")
    return lambda x: np.sqrt(np.maximum(0.0, 1.0 - np.square(beyond(x, start, end))))


def beyond(x: np.ndarray, start: float, end: float) -> np.ndarray:
    """How far before the end: 0 from there on, 1 up to the start."""
    return np.clip((end - x) / (end - start), 0.0, 1.0)


def semi_ellipse(one: float, other: float) -> Curve:
    require(one != other, "two different ends")
    centre, radius = 0.5 * (one + other), 0.5 * abs(other - one)
    return lambda x: np.sqrt(np.maximum(0.0, 1.0 - np.square((x - centre) / radius)))


# x of a membership, of shapes that only rise or only fall: what Tsukamoto's method takes.


def ramp_inverse(zero: float, one: float) -> Curve:
    return lambda mu: zero + (one - zero) * mu


def sigmoid_inverse(inflection: float, slope: float) -> Curve:
    return lambda mu: inflection - np.log(1.0 / mu - 1.0) / slope


def s_inverse(start: float, end: float) -> Curve:
    """From the value 0 at start to 1 at end, whichever is the larger."""
    low = lambda mu: start + (end - start) * np.sqrt(0.5 * mu)  # noqa: E731
    high = lambda mu: end - (end - start) * np.sqrt(0.5 * np.maximum(0.0, 1.0 - mu))  # noqa: E731
    return lambda mu: np.where(mu <= 0.5, low(mu), high(mu))


def z_inverse(start: float, end: float) -> Curve:
    return s_inverse(end, start)


def concave_inverse(inflection: float, end: float) -> Curve:
    return lambda mu: (inflection - end) / mu + 2.0 * end - inflection


def arc_inverse(start: float, end: float) -> Curve:
    return lambda mu: end - (end - start) * np.sqrt(np.maximum(0.0, 1.0 - np.square(mu)))


@dataclass(frozen=True)
class Shape:
    """make(*parameters[i] for i in order) gives points (straight) or a curve. knots: where a curve
    may bend or jump; inverse: of one that only rises or falls; both of its parameters."""

    make: Callable[..., tuple[Point, ...] | Curve]
    parameters: int
    order: tuple[int, ...] = ()
    is_smooth: bool = False
    knots: Callable[..., tuple[float, ...]] = lambda *_: ()
    inverse: Callable[..., Curve] | None = None

    def ordered(self, values: Sequence[float]) -> list[float]:
        return [values[i] for i in self.order or range(self.parameters)]

    def as_in_file(self, ordered: Sequence[float]) -> list[float]:
        """The other way round."""
        order = self.order or range(self.parameters)
        return [ordered[list(order).index(i)] for i in range(self.parameters)]

    def __call__(self, values: Sequence[float]) -> tuple[Point, ...] | Curve:
        return self.make(*self.ordered(values))


def straight(make: Callable[..., tuple[Point, ...]], parameters: int) -> Shape:
    return Shape(make, parameters)


def smooth(make: Callable[..., Curve], *order: int) -> Shape:
    """order: where the file has each of the function's parameters."""
    return Shape(make, len(order), order, True, *MORE.get(make, ()))


def ends(*parameters: float) -> tuple[float, ...]:
    return parameters


def halves(start: float, end: float) -> tuple[float, ...]:
    return start, 0.5 * (start + end), end


# Knots beside a narrow curve's middle, so that it is not overlooked in a wide universe.


def around_gaussian(mean: float, deviation: float) -> tuple[float, ...]:
    return mean - 4.0 * deviation, mean, mean + 4.0 * deviation


def around_both_gaussians(
    mean_a: float, sd_a: float, mean_b: float, sd_b: float
) -> tuple[float, ...]:
    return *around_gaussian(mean_a, sd_a), *around_gaussian(mean_b, sd_b)


def around_sigmoid(inflection: float, slope: float) -> tuple[float, ...]:
    width = 8.0 / max(abs(slope), 1e-30)
    return inflection - width, inflection, inflection + width


def around_both_sigmoids(left: float, rise: float, fall: float, right: float) -> tuple[float, ...]:
    return *around_sigmoid(left, rise), *around_sigmoid(right, fall)


# Knots and inverses of those that have any.
MORE: dict[Callable, tuple] = {
    gaussian: (around_gaussian,),
    two_gaussians: (around_both_gaussians,),
    bell: (lambda centre, width, _slope: (centre - width, centre, centre + width),),
    sigmoid: (around_sigmoid, sigmoid_inverse),
    sigmoid_difference: (around_both_sigmoids,),
    sigmoid_product: (around_both_sigmoids,),
    s_shape: (halves, s_inverse),
    z_shape: (halves, z_inverse),
    pi_shape: (lambda a, b, c, d: (*halves(a, b), *halves(c, d)),),
    cosine: (lambda centre, width: (centre - 0.5 * width, centre + 0.5 * width),),
    spike: (lambda centre, _width: (centre,),),
    concave: (lambda _inflection, end: (end,), concave_inverse),
    arc: (ends, arc_inverse),
    semi_ellipse: (ends,),
}
RAMP = Shape(ramp_points, 2, inverse=ramp_inverse)


FLL_SHAPES = {
    "Triangle": straight(triangle_points, 3),
    "Trapezoid": straight(trapezoid_points, 4),
    "Rectangle": straight(rectangle_points, 2),
    "Ramp": RAMP,
    "Binary": straight(binary_points, 2),
    "Arc": smooth(arc, 0, 1),
    "SemiEllipse": smooth(semi_ellipse, 0, 1),
    "Gaussian": smooth(gaussian, 0, 1),
    "GaussianProduct": smooth(two_gaussians, 0, 1, 2, 3),
    "Bell": smooth(bell, 0, 1, 2),
    "Sigmoid": smooth(sigmoid, 0, 1),
    "SigmoidDifference": smooth(sigmoid_difference, 0, 1, 2, 3),
    "SigmoidProduct": smooth(sigmoid_product, 0, 1, 2, 3),
    "SShape": smooth(s_shape, 0, 1),
    "ZShape": smooth(z_shape, 0, 1),
    "PiShape": smooth(pi_shape, 0, 1, 2, 3),
    "Cosine": smooth(cosine, 0, 1),
    "Spike": smooth(spike, 0, 1),
    "Concave": smooth(concave, 0, 1),
}

FIS_SHAPES = {
    "trimf": straight(triangle_points, 3),
    "trapmf": straight(trapezoid_points, 4),
    "linsmf": straight(rising_points, 2),
    "linzmf": straight(falling_points, 2),
    "gaussmf": smooth(gaussian, 1, 0),
    "gauss2mf": smooth(two_gaussians, 1, 0, 3, 2),
    "gbellmf": smooth(bell, 2, 0, 1),
    "sigmf": smooth(sigmoid, 1, 0),
    "dsigmf": smooth(sigmoid_difference, 1, 0, 2, 3),
    "psigmf": smooth(sigmoid_product, 1, 0, 2, 3),
    "smf": smooth(s_shape, 0, 1),
    "zmf": smooth(z_shape, 0, 1),
    "pimf": smooth(pi_shape, 0, 1, 2, 3),
    # FuzzyLite's
    "rampmf": RAMP,
    "rectmf": straight(rectangle_points, 2),
    "cosinemf": smooth(cosine, 0, 1),
    "concavemf": smooth(concave, 0, 1),
    "spikemf": smooth(spike, 0, 1),
    "binarymf": straight(binary_points, 2),
    "arcmf": smooth(arc, 0, 1),
    "semiellipsemf": smooth(semi_ellipse, 0, 1),
}

# Words of jFuzzyLogic's dialect.
FCL_SHAPES = {
    "TRIAN": straight(triangle_points, 3),
    "TRAPE": straight(trapezoid_points, 4),
    "GAUSS": smooth(gaussian, 0, 1),
    "GAUSS2": smooth(two_gaussians, 0, 1, 2, 3),
    "GBELL": smooth(bell, 2, 0, 1),
    "SIGM": smooth(sigmoid, 1, 0),
    "DSIGM": smooth(sigmoid_difference, 1, 0, 2, 3),
}


def values_of(curve: Curve, x: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        values = curve(x)
    require(bool(np.all(np.isfinite(values))), "parameters that give a number everywhere")
    return np.clip(values, 0.0, 1.0)


def chain(curve: Curve, low: float, high: float, segments: int) -> tuple[tuple[Point, ...], float]:
    """At most so many straight segments between points of the curve, and their largest error.

    The least error at which `segments` are enough is found by halving; for a given error each
    segment reaches as far as it can.
    """
    x = np.linspace(low, high, GRID_STEPS + 1)
    mu = values_of(curve, x)
    least, most = 0.0, 1.0
    best = breakpoints(x, mu, most)
    for _ in range(30):
        error = 0.5 * (least + most)
        found = breakpoints(x, mu, error)
        if len(found) <= segments + 1:
            best, most = found, error
        else:
            least = error
    fine = np.linspace(low, high, ERROR_STEPS + 1)
    error = np.abs(np.interp(fine, x[best], mu[best]) - values_of(curve, fine)).max()
    return tuple(zip(x[best].tolist(), mu[best].tolist(), strict=True)), float(error)


def breakpoints(x: np.ndarray, mu: np.ndarray, error: float) -> list[int]:
    """Indices of x; each chord stays within the error of the curve."""
    found = [0]
    while found[-1] < len(x) - 1:
        found.append(farthest(x, mu, found[-1], error))
    return found


def farthest(x: np.ndarray, mu: np.ndarray, start: int, error: float) -> int:
    """The last index of a doubling, then halving, search at which the chord still fits."""
    last = len(x) - 1
    good, step = start + 1, 1
    while good < last and fits(x, mu, start, min(good + step, last), error):
        good, step = min(good + step, last), 2 * step
    bad = min(good + step, last + 1)
    while bad - good > 1:
        middle = (good + bad) // 2
        if fits(x, mu, start, middle, error):
            good = middle
        else:
            bad = middle
    return good


def fits(x: np.ndarray, mu: np.ndarray, start: int, end: int, error: float) -> bool:
    part = slice(start, end + 1)
    chord = mu[start] + (mu[end] - mu[start]) * (x[part] - x[start]) / (x[end] - x[start])
    return bool(np.abs(chord - mu[part]).max() <= error)
