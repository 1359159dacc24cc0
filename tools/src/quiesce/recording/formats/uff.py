"""Universal files: data sets 58 against time, ASCII or binary, by pyuff."""

from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.extras import extra
from quiesce.base.paths import shown
from quiesce.recording.arrays import table_of, with_unit
from quiesce.recording.table import Table

KIND = "universal file"
FUNCTION = 58
TIME = 17  # of abscissae: type of their data
DIRECTIONS = {1: "x", 2: "y", 3: "z"}
ALIKE = 1e-6  # times of two data sets, in sample periods


def read(file: Path) -> Table:
    """One column a data set, named by its first line of identification where no other has it, else
    by node and direction; UsageError where they are not all against one time."""
    with extra("files", "a universal file"):
        import pyuff

    stream = pyuff.UFF(str(file))
    numbers = [number for number, kind in enumerate(stream.get_set_types()) if kind == FUNCTION]
    sets = [stream.read_sets(number) for number in numbers]
    if not sets:
        raise UsageError(f"{shown(file)}: no data set {FUNCTION} in this {KIND}; export functions")
    for one in sets:
        _require_time(file, one, sets[0])
    names = [str(one.get("id1", "")).strip() for one in sets]
    found: dict[str, Any] = {"time [s]": np.asarray(sets[0]["x"], float)}
    for one, name in zip(sets, names, strict=True):
        is_told = name not in ("", "NONE") and names.count(name) == 1
        label = name if is_told else _place(one)
        found[with_unit(label, one.get("ordinate_axis_units_lab", ""))] = np.asarray(one["data"])
    return table_of(file, KIND, found)


def _place(one: dict[str, Any]) -> str:
    axis = int(one.get("rsp_dir", 0))
    sign = "-" if axis < 0 else ""
    return f"node_{one.get('rsp_node', 0)}_{sign}{DIRECTIONS.get(abs(axis), axis)}"


def _require_time(file: Path, one: dict[str, Any], first: dict[str, Any]) -> None:
    if one.get("abscissa_spec_data_type", TIME) not in (TIME, 0):
        raise UsageError(
            f"{shown(file)}: a function that is not against time (spectrum, frequency response); "
            "export time histories"
        )
    times_s, first_s = np.asarray(one["x"], float), np.asarray(first["x"], float)
    is_same = len(times_s) == len(first_s) and len(times_s) > 1
    if not is_same or np.abs(times_s - first_s).max() > ALIKE * (first_s[1] - first_s[0]):
        raise UsageError(
            f"{shown(file)}: its functions are sampled at different times; export them with one "
            "rate, start and length"
        )
