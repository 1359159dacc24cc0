"""A rule base in integers, as plain data (compile.py makes it)."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from quiesce.rules.integers.cells import Axis, Cell
from quiesce.rules.integers.output_shapes import OutputShapes
from quiesce.rules.model import RuleBase

WEIGHT_ONE = 1 << 19
EXPONENT_STEP = 3
MAX_EXPONENT = 7 * EXPONENT_STEP


@dataclass(frozen=True)
class IntegerRule:
    """conditions: (input, place of the set from left to right, negated); conclusions: the term's
    place in IntegerOutput, or None."""

    conditions: tuple[tuple[int, int, bool], ...]
    conclusions: tuple[int | None, ...]
    is_or: bool
    weight_q19: int
    exponent: int  # the weight is 2^-exponent of that

    @property
    def is_full(self) -> bool:
        """Without a weight."""
        return self.weight_q19 == WEIGHT_ONE and self.exponent == 0


@dataclass(frozen=True)
class IntegerOutput:
    method: str
    axis: Axis  # of the output's integers
    origin: int  # the smallest value that it can take
    default: int
    terms: tuple[int, ...]  # singletons less the origin, in 2^-fraction; or places of the sets
    fraction: int
    span: int  # counts of a centroid's universe, from the origin
    shapes: OutputShapes | None


@dataclass(frozen=True)
class CompiledBase:
    base: RuleBase
    axes: tuple[Axis, ...]
    cells: tuple[tuple[Cell, ...], ...]  # of each input, in order, over all of int32
    rules: tuple[IntegerRule, ...]
    outputs: tuple[IntegerOutput, ...]
    bits: int  # 2^bits is membership 1
    is_grid: bool  # two inputs, at most two sets overlap, one plain rule for every pair of sets
    is_partition: bool  # is_grid, one output, memberships that add up to 1 everywhere
    notes: tuple[str, ...]
    set_order: tuple[tuple[int, ...], ...]  # of each input: its sets from left to right

    def input_integer(self, index: int, x: np.ndarray | float) -> np.ndarray:
        """Nearest integer, after clamping x to the universe; int32."""
        variable, axis = self.base.inputs[index], self.axes[index]
        clamped = np.clip(np.asarray(x, dtype=float), variable.minimum, variable.maximum)
        counts = (clamped - float(axis.origin)) / float(axis.lsb)
        return np.floor(counts + 0.5).astype(np.int32)

    def input_value(self, index: int, n: np.ndarray | int) -> np.ndarray:
        """What an input's integer stands for, in the variable's unit."""
        axis = self.axes[index]
        return float(axis.origin) + np.asarray(n, dtype=float) * float(axis.lsb)

    def output_value(self, index: int, n: np.ndarray | int) -> np.ndarray:
        axis = self.outputs[index].axis
        return float(axis.origin) + np.asarray(n, dtype=float) * float(axis.lsb)

    def output_lsb(self, index: int) -> float:
        return float(self.outputs[index].axis.lsb)

    @property
    def is_for_controller(self) -> bool:
        """From uHz and um/s2 to mA, if the file has Hz, m/s2 and A."""
        inputs = [(axis.origin, axis.lsb) for axis in self.axes]
        outputs = [(output.axis.origin, output.axis.lsb) for output in self.outputs]
        micro, milli = Fraction(1, 10**6), Fraction(1, 1000)
        return inputs == [(0, micro)] * 2 and outputs == [(0, milli)]

    @property
    def strength_shift(self) -> int:
        """FUZZY_STRENGTH_SHIFT of the firmware."""
        return 8 + len(self.rules).bit_length()


def pair_of(rule: IntegerRule) -> tuple[int, int] | None:
    """The sets of both inputs, where the rule is a plain one of a grid."""
    is_plain = (
        not rule.is_or
        and rule.is_full
        and len(rule.conditions) == 2
        and {c[0] for c in rule.conditions} == {0, 1}
        and not any(c[2] for c in rule.conditions)
        and None not in rule.conclusions
    )
    if not is_plain:
        return None
    by_input = {c[0]: c[1] for c in rule.conditions}
    return by_input[0], by_input[1]
