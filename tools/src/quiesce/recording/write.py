"""Columns into files, text and those of other programs: a function and a line in WRITERS each."""

import csv
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from quiesce.base.extras import extra
from quiesce.recording.columns import ROLES
from quiesce.recording.units import normal

Columns = Mapping[str, np.ndarray]
Text = Callable[[Any], str]
Texts = Mapping[str, Text]
TIME_HISTORY, TIME = 1, 17  # of a universal data set 58: function, abscissa
NAME_LETTERS, LABEL_LETTERS = 80, 20


def write_mat(file: Path, columns: Columns) -> None:
    """Version 5, a variable a column under its name, as columns."""
    from scipy.io import savemat

    savemat(file, dict(columns), appendmat=False, oned_as="column", long_field_names=True)


def write_uff(file: Path, columns: Columns) -> None:
    """Data sets 58 as text, against the first column, the time in s at even steps; the unit that a
    name ends in is the ordinate's. Times have six digits there."""
    pyuff = _pyuff()
    (_, time_s), *others = columns.items()
    stream = pyuff.UFF(str(file))
    for number, (name, values) in enumerate(others, 1):
        stem, unit = name_and_unit(name)
        one = pyuff.prepare_58(
            binary=0, func_type=TIME_HISTORY, rsp_node=number, rsp_dir=1, ref_node=0, ref_dir=0,
            data=np.asarray(values, float), x=np.asarray(time_s, float), id1=stem[:NAME_LETTERS],
            abscissa_spacing=1, abscissa_spec_data_type=TIME, return_full_dict=True,
        )  # fmt: skip
        # It writes whole descriptions only.
        one = {key: _blank(key) if value is None else value for key, value in one.items()}
        one |= {"abscissa_axis_units_lab": "s", "ordinate_axis_units_lab": unit}
        one |= {"abscissa_axis_lab": "Time", "ordinate_axis_lab": stem[:LABEL_LETTERS]}
        stream.write_sets(one, "overwrite" if number == 1 else "add")


def _pyuff() -> ModuleType:
    with extra("files", "a universal file"):
        import pyuff
    return pyuff


def _blank(key: str) -> str | int:
    """Of a field that says nothing: texts by the ends of their names, the others are numbers."""
    return "NONE" if key.startswith("id") or key.endswith(("_lab", "_name")) else 0


def name_and_unit(name: str) -> tuple[str, str]:
    """'floor_accel_m_s2' is floor_accel in m/s2; the unit is empty where the name ends in none."""
    ends = (name[i + 1 :] for i, letter in enumerate(name) if letter == "_" and i > 0)
    for end in ends:
        if any(normal(end) in role.units for role in ROLES.values()):
            return name[: -len(end) - 1], end.replace("_", "/")
    return name, ""


# By the suffix of the name.
WRITERS: dict[str, Callable[[Path, Columns], None]] = {
    ".mat": write_mat,
    ".uff": write_uff,
    ".unv": write_uff,
}
# What a command that names its files itself can be asked for.
FORMATS = ("csv", "mat", "uff")


def require_writer(suffix: str) -> None:
    """UsageError where what write_columns needs for files of this suffix (.uff) is not installed:
    to be called before the work whose results they are to hold."""
    if WRITERS.get(suffix.lower()) is write_uff:
        _pyuff()


def write_columns(file: Path, columns: Columns, texts: Texts | None = None) -> None:
    """As the suffix asks for, as text without one that is known. Columns of one length, the first
    the time in s at even steps; units end the names. texts: how a column's numbers are written as
    text; others as whole numbers where they are such, with nine digits where not."""
    if (writer := WRITERS.get(file.suffix.lower())) is not None:
        writer(file, {name: np.asarray(values, float) for name, values in columns.items()})
        return
    texts = texts or {}
    cells = [
        map(texts.get(name, _text_of(np.asarray(values))), np.asarray(values).tolist())
        for name, values in columns.items()
    ]
    with file.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows(zip(*cells, strict=True))


def _text_of(values: np.ndarray) -> Text:
    return str if values.dtype.kind in "iub" else "{:.9g}".format


def time_text(time_s: float) -> str:
    """To the microsecond, without zeros at the end."""
    return f"{time_s:.6f}".rstrip("0").rstrip(".")
