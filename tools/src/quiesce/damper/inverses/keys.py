"""Keys of inverses in files. UsageError with file and key where one is wrong."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.split import is_number
from quiesce.damper.learned.inputs import Box
from quiesce.network.dense import Network

MOST_UNITS = 1024
_MOST_LAG = 10_000


def number(table: Mapping[str, Any], key: str, where: str) -> float:
    """A number > 0."""
    value = table.get(key)
    if not is_number(value) or not 0.0 < value < 1e12:
        raise UsageError(f"{where}: {key}: expected a number > 0, found {value!r}")
    return float(value)


def numbers(values: Any, count: int, key: str) -> np.ndarray:
    good = isinstance(values, list) and all(is_number(one) for one in values)
    if not good or len(values) != count:
        found = len(values) if isinstance(values, list) else repr(values)
        raise UsageError(f"{key}: expected {count} finite numbers, found {found}")
    return np.array(values, dtype=float)


def table_of(table: Mapping[str, Any], key: str, where: str) -> dict[str, Any]:
    found = table.get(key)
    if not isinstance(found, dict):
        raise UsageError(f"{where}: {key}: expected a table [{key}]")
    return found


def lags_of(table: Mapping[str, Any], key: str, least: int, where: str) -> tuple[int, ...]:
    """Integers that rise from `least` or more."""
    found = table.get(key)
    good = isinstance(found, list) and found and all(type(one) is int for one in found)
    if not good or any(b <= a for a, b in zip([least - 1, *found[:-1]], found, strict=True)):
        raise UsageError(f"{where}: {key}: expected integers rising from {least} or more")
    if found[-1] > _MOST_LAG:
        raise UsageError(f"{where}: {key}: {found[-1]} is more than {_MOST_LAG}")
    return tuple(found)


def box_of(table: Mapping[str, Any], keys: Sequence[str], where: str) -> Box:
    """Ranges of the inputs."""
    low, high = [], []
    for key in keys:
        limits = numbers(table_of(table, key, where).get("range"), 2, f"{where}: {key}.range")
        if not limits[0] < limits[1]:
            raise UsageError(f"{where}: {key}.range: expected [FROM, TO] with FROM below TO")
        low.append(limits[0])
        high.append(limits[1])
    return Box(tuple(keys), np.array(low), np.array(high))


def network_of(tables: Any, inputs: int, where: str) -> Network:
    """[[layer]] with one output."""
    if not isinstance(tables, list) or not tables or not all(isinstance(t, dict) for t in tables):
        raise UsageError(f"{where}: layer: expected tables [[layer]] with weights and biases")
    weights, biases = [], []
    for k, table in enumerate(tables):
        key = f"{where}: layer[{k + 1}]"
        units = 1 if k == len(tables) - 1 else table.get("units")
        if type(units) is not int or not 1 <= units <= MOST_UNITS:
            raise UsageError(f"{key}.units: expected an integer in 1 .. 1024, found {units!r}")
        rows = numbers(table.get("weights"), units * inputs, f"{key}.weights")
        weights.append(rows.reshape(units, inputs))
        biases.append(numbers(table.get("biases"), units, f"{key}.biases"))
        inputs = units
    return Network(weights, biases)
