"""What a rule file says, whatever of it a plain rule base (rules/model.py) can hold.

Rules are taken in order, block after block. A rule's strength is its weight times its expression;
a condition names an input, or an output, which then counts with what its term has been activated
with so far. The value of an output:

BY_RULE   sum of strength x value over its rules / sum of their strengths
BY_TERM   the same over its terms, each with its rules' strengths aggregated
WEIGHTED  sum of strength x value over its rules
the rest  of the aggregation over its rules of implication(strength, set), taken in the middle of
          `places` equal parts of its universe

A value is a constant, a straight line over the inputs, a function of inputs and of outputs before
its own, or of the strength (Tsukamoto). Where no rule fires, or sets are 0 everywhere, an output
has its default. Inputs clamp to their universe first.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from quiesce.rules.system.formula import Tree

Function = Callable[[np.ndarray], np.ndarray]
Point = tuple[float, float]

BY_RULE, BY_TERM, WEIGHTED = "average by rule", "average by term", "weighted sum"
CENTROID, BISECTOR = "centroid", "bisector"
SMALLEST, LARGEST, MEAN = "smallest of maximum", "largest of maximum", "mean of maximum"
VALUE_METHODS = (BY_RULE, BY_TERM, WEIGHTED)
SET_METHODS = (CENTROID, BISECTOR, SMALLEST, LARGEST, MEAN)

MAX_INPUTS = 8
MAX_OUTPUTS = 4
MAX_TERMS = 32  # of an input, and of an output with sets or by term
MAX_VALUES = 64
MAX_ALL_TERMS = 128  # of all inputs together, and of all outputs
MAX_RULES = 1024
MAX_LISTED = 64  # rules, where they are aggregated one by one
MAX_PLACES = 1024
MAX_DEPTH = 8  # of an expression's stack


@dataclass(frozen=True)
class Origin:
    """How a file says a curve. make: of formats/shapes.py, with its parameters and a height; tree:
    of a formula."""

    make: Callable | None = None
    parameters: tuple[float, ...] = ()
    height: float = 1.0
    tree: Tree | None = None


@dataclass(frozen=True)
class Curve:
    """A function of one number. points: where it is made of straight lines; two of equal x are a
    vertical edge, at which the greater value holds, and both ends are held beyond them. knots:
    where it may bend or jump otherwise. origin: None where points say all."""

    word: str
    function: Function = field(compare=False)
    points: tuple[Point, ...] | None = None
    knots: tuple[float, ...] = ()
    origin: Origin | None = field(default=None, compare=False)


@dataclass(frozen=True)
class SetTerm:
    name: str
    curve: Curve


@dataclass(frozen=True)
class ConstantTerm:
    name: str
    value: float


@dataclass(frozen=True)
class LinearTerm:
    """constant + sum of slopes x inputs."""

    name: str
    slopes: tuple[float, ...]
    constant: float


@dataclass(frozen=True)
class InputTerm:
    """A function of one input."""

    name: str
    input: int
    curve: Curve


@dataclass(frozen=True)
class FormulaTerm:
    """A function of several inputs, or of outputs before its own, as they come out."""

    name: str
    tree: Tree
    inputs: tuple[tuple[str, int], ...]  # names in the tree, and what they stand for
    outputs: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True)
class StrengthTerm:
    """A function of the strength, 0 .. 1. is_inverse: where its curve's origin reaches that."""

    name: str
    curve: Curve
    is_inverse: bool = False


@dataclass(frozen=True)
class ProductTerm:
    """Functions of one input, or of the strength: the value, already multiplied with its rule's
    strength, and that."""

    name: str
    input: int | None  # None: of the strength
    curve: Curve
    strength: Function = field(compare=False)


ValueTerm = ConstantTerm | LinearTerm | InputTerm | FormulaTerm | StrengthTerm | ProductTerm


@dataclass(frozen=True)
class SystemInput:
    name: str
    minimum: float
    maximum: float
    terms: tuple[SetTerm, ...]


@dataclass(frozen=True)
class SystemOutput:
    """clips: a weighted value stays within the universe."""

    name: str
    minimum: float
    maximum: float
    terms: tuple[SetTerm, ...] | tuple[ValueTerm, ...]
    method: str
    aggregation: str  # an S-norm of norms.py
    places: int
    default: float | None = None  # None: the file does not say
    clips: bool = False


@dataclass(frozen=True)
class Proposition:
    """`variable IS hedges term`; hedges as written, so that the last is applied first. at: where a
    reader found its variable and its hedges, offsets in the text, for messages."""

    is_input: bool
    variable: int
    term: int
    hedges: tuple[str, ...] = ()
    at: tuple[int, int] = field(default=(0, 0), compare=False)


@dataclass(frozen=True)
class Join:
    """connective: AND or OR of rules/model.py."""

    connective: str
    parts: tuple["Expression", ...]


@dataclass(frozen=True)
class Complement:
    """1 - part."""

    part: "Expression"


Expression = Proposition | Join | Complement


@dataclass(frozen=True)
class Conclusion:
    """hedges: in the order in which they are applied."""

    output: int
    term: int
    hedges: tuple[str, ...] = ()
    at: int = field(default=0, compare=False)


@dataclass(frozen=True)
class SystemRule:
    block: int
    expression: Expression
    conclusions: tuple[Conclusion, ...]
    weight: float = 1.0


@dataclass(frozen=True)
class Block:
    """Norms of norms.py; any where no rule needs it."""

    conjunction: str
    disjunction: str
    implication: str


@dataclass(frozen=True)
class System:
    name: str
    inputs: tuple[SystemInput, ...]
    outputs: tuple[SystemOutput, ...]
    blocks: tuple[Block, ...]
    rules: tuple[SystemRule, ...]
    notes: tuple[str, ...] = field(default=(), compare=False)
