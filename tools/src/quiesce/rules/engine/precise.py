"""A fuzzy system in integers, as fine as its outputs need: its smooth curves get more pieces until
the firmware's engine, run here, answers like float64."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.engine.function_engine import FunctionEngine
from quiesce.rules.engine.system_engine import SystemEngine
from quiesce.rules.straight.compile import StraightSystem
from quiesce.rules.system.compile import CompiledSystem, compile_system
from quiesce.rules.system.model import LARGEST, MEAN, SMALLEST, System
from quiesce.rules.system.reference import WEAKEST, evaluate

TOLERANCES = tuple(2.0**-bits for bits in (12, 14, 16, 18, 20, 22))
GOOD = 3e-4  # of an output's range
POINTS = 2000
# Of points that are judged where an output jumps from one peak to another, as like as not.
SHARE_OF_MAXIMA = 0.99
MAXIMA = (SMALLEST, LARGEST, MEAN)
SEED = 1


@dataclass(frozen=True)
class Precise:
    """errors: of each output the largest over its range (of a maximum: at SHARE_OF_MAXIMA of the
    points), at POINTS random counts of the inputs, where some rule of it fires by WEAKEST;
    mistaken: where it has its default and float64 does not, or the other way round."""

    compiled: CompiledSystem | StraightSystem
    errors: tuple[float, ...]
    mistaken: int

    @property
    def error(self) -> float:
        return max(self.errors)


def compile_precisely(
    system: System,
    inputs: Sequence[float | str] | None = None,
    outputs: Sequence[float | str] | None = None,
    defaults: Mapping[str, float] | None = None,
) -> Precise:
    """The coarsest that is good; the best, where none is. UsageError as compile_system."""
    best: Precise | None = None
    for tolerance in TOLERANCES:
        try:
            compiled = compile_system(system, inputs, outputs, defaults, tolerance)
        except UsageError:
            if best is None or tolerance == TOLERANCES[0]:
                raise
            break
        found = judged(compiled)
        if best is None or found.error < 0.7 * best.error:
            best = found
        if best.error <= GOOD or compiled.curve_error == 0.0:
            break
    assert best is not None
    return best


def judged(compiled: CompiledSystem | StraightSystem) -> Precise:
    system = compiled.system
    is_table = isinstance(compiled, CompiledSystem)
    engine = SystemEngine(compiled) if is_table else FunctionEngine(compiled)
    rng = np.random.default_rng(SEED)
    counts = [
        compiled.input_integer(i, rng.uniform(one.minimum, one.maximum, POINTS))
        for i, one in enumerate(system.inputs)
    ]
    out, defaults = engine.evaluate(counts)
    wanted = evaluate(system, [compiled.input_value(i, one) for i, one in enumerate(counts)])
    errors, mistaken = [], 0
    for i, output in enumerate(system.outputs):
        is_default = (defaults >> i & 1) > 0
        is_strong = wanted.strongest[i] >= WEAKEST
        judged_here = ~is_default & ~wanted.is_default[i] & is_strong
        off = np.abs(compiled.output_value(i, out[i]) - wanted.outputs[i])[judged_here]
        share = SHARE_OF_MAXIMA if output.method in MAXIMA else 1.0
        worst = float(np.quantile(off, share)) if off.size else 0.0
        errors.append(worst / (output.maximum - output.minimum))
        mistaken += int(((is_default != wanted.is_default[i]) & is_strong).sum())
    return Precise(compiled, tuple(errors), mistaken)
