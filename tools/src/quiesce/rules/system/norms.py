"""Norms and hedges in float64, by FuzzyLite's names; firmware/fuzzy/fuzzy_norms.h has the codes.

Values are memberships, 0 .. 1, in arrays of any shapes that numpy broadcasts together.
"""

from collections.abc import Callable

import numpy as np

Norm = Callable[[np.ndarray, np.ndarray], np.ndarray]
Hedge = Callable[[np.ndarray], np.ndarray]

MINIMUM, MAXIMUM = "Minimum", "Maximum"
ALGEBRAIC_PRODUCT, UNBOUNDED_SUM = "AlgebraicProduct", "UnboundedSum"


def hamacher_product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a b / (a + b - a b); 0 of nothing."""
    divisor = a + b - a * b
    return np.where(divisor == 0.0, 0.0, a * b / np.where(divisor == 0.0, 1.0, divisor))


# In the order of fuzzy_norm_t.
T_NORMS: dict[str, Norm] = {
    MINIMUM: np.minimum,
    ALGEBRAIC_PRODUCT: lambda a, b: a * b,
    "BoundedDifference": lambda a, b: np.maximum(0.0, a + b - 1.0),
    "DrasticProduct": lambda a, b: np.where(np.maximum(a, b) == 1.0, np.minimum(a, b), 0.0),
    "EinsteinProduct": lambda a, b: a * b / (2.0 - (a + b - a * b)),
    "HamacherProduct": hamacher_product,
    "NilpotentMinimum": lambda a, b: np.where(a + b > 1.0, np.minimum(a, b), 0.0),
}
FIRST_S_NORM = 16
S_NORMS: dict[str, Norm] = {
    MAXIMUM: np.maximum,
    "AlgebraicSum": lambda a, b: a + b - a * b,
    "BoundedSum": lambda a, b: np.minimum(1.0, a + b),
    "DrasticSum": lambda a, b: np.where(np.minimum(a, b) == 0.0, np.maximum(a, b), 1.0),
    "EinsteinSum": lambda a, b: (a + b) / (1.0 + a * b),
    # By its dual: near 1 the quotient (a + b - 2 a b) / (1 - a b) is nothing but rounding.
    "HamacherSum": lambda a, b: 1.0 - hamacher_product(1.0 - a, 1.0 - b),
    "NilpotentMaximum": lambda a, b: np.where(a + b < 1.0, np.maximum(a, b), 1.0),
    "NormalizedSum": lambda a, b: (a + b) / np.maximum(1.0, a + b),
    UNBOUNDED_SUM: lambda a, b: a + b,
}
NORMS = T_NORMS | S_NORMS

NOT = "not"
ANY = "any"
# In the order of fuzzy_hedge_t, from 1 on.
HEDGES: dict[str, Hedge] = {
    NOT: lambda x: 1.0 - x,
    "very": np.square,
    "somewhat": np.sqrt,
    "extremely": lambda x: np.where(x <= 0.5, 2.0 * x**2, 1.0 - 2.0 * (1.0 - x) ** 2),
    "seldom": lambda x: np.where(x <= 0.5, np.sqrt(0.5 * x), 1.0 - np.sqrt(0.5 * (1.0 - x))),
    "cubed": lambda x: x**3,
}


def norm_code(name: str) -> int:
    if name in T_NORMS:
        return list(T_NORMS).index(name)
    return FIRST_S_NORM + list(S_NORMS).index(name)


def hedge_code(name: str | None) -> int:
    """0: none."""
    return 0 if name is None else 1 + list(HEDGES).index(name)
