"""Parquet: its columns; a unit is in the field's metadata, key `unit`."""

from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.extras import extra
from quiesce.recording.arrays import table_of, with_unit
from quiesce.recording.table import Table

KIND = "Parquet file"


def read(file: Path) -> Table:
    """Times of day become seconds since the first one. What is missing is NaN, which is refused
    where it is used."""
    with extra("files", "a Parquet file"):
        import pyarrow.parquet

    table = pyarrow.parquet.ParquetFile(file).read()
    found: dict[str, Any] = {}
    for field, column in zip(table.schema, table.columns, strict=True):
        values, unit = column.to_numpy(), (field.metadata or {}).get(b"unit", b"")
        if values.dtype.kind in "mM":
            values, unit = (values - values[:1]) / np.timedelta64(1, "s"), b"s"
        found[with_unit(field.name, unit)] = values
    return table_of(file, KIND, found)
