"""How far Karnik and Mendel's reduction of interval type-2 rules lies from Nie and Tan's.

Karnik and Mendel answer the middle of the least and the greatest weighted average that strengths
within their intervals can make (Information Sciences 132, 2001); Nie and Tan the average with the
middle of each interval (FUZZ-IEEE 2008), which is what this package computes.
"""

from collections.abc import Callable

import numpy as np


def nie_tan(strengths: np.ndarray, values: np.ndarray) -> np.ndarray:
    """strengths: [end, rule, point], the lower end first; values alike, of the conclusions. NaN
    where no rule fires."""
    middle, value = strengths.mean(axis=0), values.mean(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return (middle * value).sum(axis=0) / middle.sum(axis=0)


def karnik_mendel(strengths: np.ndarray, values: np.ndarray) -> np.ndarray:
    """As nie_tan. The extremes are found among all places where the strengths may switch from one
    end to the other, rules in the order of their values."""
    lower, upper = strengths.min(axis=0), strengths.max(axis=0)
    least = _extreme(upper, lower, values[0], np.nanmin)
    greatest = _extreme(lower, upper, values[1], np.nanmax)
    return 0.5 * (least + greatest)


def _extreme(
    below: np.ndarray, above: np.ndarray, values: np.ndarray, choose: Callable
) -> np.ndarray:
    """below: the strengths of the smaller values' rules, up to a switch; all [rule, point]."""
    order = np.argsort(values, axis=0)
    value, first, rest = (np.take_along_axis(one, order, axis=0) for one in (values, below, above))
    weighted = _switched(first * value, rest * value)
    total = _switched(first, rest)
    is_fired = np.maximum(below, above).sum(axis=0) > 0
    with np.errstate(invalid="ignore", divide="ignore"):
        averages = np.where(total > 0, weighted / total, np.nan)
    found = np.full(is_fired.shape, np.nan)
    found[is_fired] = choose(averages[:, is_fired], axis=0)
    return found


def _switched(first: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """[switch, point]: sums of `first` before each switch and of `rest` from there on."""
    nothing = np.zeros((1, first.shape[1]))
    before = np.concatenate([nothing, np.cumsum(first, axis=0)])
    after = np.concatenate([nothing, np.cumsum(rest[::-1], axis=0)])[::-1]
    return before + after
