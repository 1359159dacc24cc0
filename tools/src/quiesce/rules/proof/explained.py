"""What the rounding of the integers explains at a point: how far they may be from the reference.

To first order, with strengths s off by at most e (bound.py):
  weighted average  sum e |c - average| / (sum s - sum e), singletons and the quotient to nearest
  centroid          what each strength's e moves it, plus the resolution of areas and quotient
                    (firmware/fuzzy/fuzzy_math.h)
"""

import numpy as np

from quiesce.rules.integers.bound import strength_error
from quiesce.rules.integers.compile import singleton_error
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.output_shapes import OutputShapes, Shape
from quiesce.rules.model import CENTROID, WEIGHTED_SUM
from quiesce.rules.reference import Reference, centroid, term_strengths

QUOTIENT_SHARE = 2.0**-20  # of a centroid's span
AREA_SHARE = 2.0**-24  # of a layer where a partition sums areas in 32 bits
WIDE_AREA_SHARE = 2.0**-25  # elsewhere, of the strongest term
SLACK = 1.001  # float64, second order


def explained_errors(compiled: CompiledBase, reference: Reference) -> np.ndarray:
    """[output, point] in counts of the output; 0 where the default stands.

    reference: of the inputs' integers, with strengths.
    """
    errors = [output_errors(compiled, index, reference) for index in range(len(compiled.outputs))]
    return np.where(reference.is_default, 0.0, np.stack(errors))


def output_errors(compiled: CompiledBase, index: int, reference: Reference) -> np.ndarray:
    output = compiled.base.outputs[index]
    chosen = [i for i, rule in enumerate(compiled.rules) if rule.conclusions[index] is not None]
    terms = [compiled.base.rules[i].conclusions[index] for i in chosen]
    assert reference.strengths is not None
    strengths = reference.strengths[chosen]
    unit = 2.0**-compiled.bits
    doubts = np.array([float(strength_error(compiled, compiled.rules[i])) * unit for i in chosen])
    off = np.where(strengths > 0, doubts[:, None], 0.0)
    if output.method != WEIGHTED_SUM:
        count = len(output.terms)
        strengths, off = (term_strengths(array, terms, count) for array in (strengths, off))
        terms = list(range(count))
    if output.method == CENTROID:
        return centroid_errors(compiled, index, strengths, off)
    made = compiled.outputs[index]
    values = np.array([made.terms[term] for term in terms], dtype=float) / 2**made.fraction
    rounding = float(singleton_error(made, output))
    return average_errors(values + made.origin, strengths, off, rounding)


def average_errors(
    values: np.ndarray, strengths: np.ndarray, off: np.ndarray, singleton: float
) -> np.ndarray:
    """values [rule or term] in counts; strengths and their errors [rule or term, point]."""
    with np.errstate(divide="ignore", invalid="ignore"):
        average = (strengths * values[:, None]).sum(axis=0) / strengths.sum(axis=0)
        left = strengths.sum(axis=0) - off.sum(axis=0)
        moved = (off * np.abs(values[:, None] - average)).sum(axis=0) / left
    return 0.5 + singleton + SLACK * np.where(left > 0, moved, np.inf)


def all_shapes(shapes: OutputShapes) -> list[Shape]:
    return [*shapes.shapes, *(shape for stretch in shapes.stretches for shape in stretch)]


def centroid_errors(
    compiled: CompiledBase, index: int, strengths: np.ndarray, off: np.ndarray
) -> np.ndarray:
    """strengths and their errors [term, point]."""
    output, integers = compiled.base.outputs[index], compiled.outputs[index]
    assert integers.shapes is not None
    middle, area = centroid(output, strengths)
    moved = np.zeros(strengths.shape[1])
    for term in range(len(strengths)):
        shifts = []
        for sign in (-1, 1):
            changed = strengths.copy()
            changed[term] = np.maximum(changed[term] + sign * off[term], 0.0)
            shifts.append(np.abs(centroid(output, changed)[0] - middle))
        moved += np.where(off[term] > 0, np.maximum(*shifts), 0.0)
    layers = sum(len(shape.layers) for shape in all_shapes(integers.shapes))
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (output.maximum - output.minimum) / area
        area_share = AREA_SHARE if compiled.is_partition else WIDE_AREA_SHARE
        resolution = QUOTIENT_SHARE + layers * area_share * share * strengths.max(axis=0)
    return 1.0 + SLACK * moved / float(integers.axis.lsb) + resolution * integers.span
