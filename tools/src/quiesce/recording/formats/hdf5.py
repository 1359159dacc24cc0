"""HDF5: every data set is a column, its unit an attribute `unit` or `units`."""

from pathlib import Path
from typing import Any

from quiesce.base.extras import extra
from quiesce.recording.arrays import table_of, with_unit
from quiesce.recording.table import Table

KIND = "HDF5 file"
UNITS = ("unit", "units", "Unit", "Units")


def read(file: Path) -> Table:
    """Data sets in groups are 'group.name'."""
    with extra("files", "an HDF5 file"):
        import h5py

    found: dict[str, Any] = {}

    def take(path: str, one: Any) -> None:
        if isinstance(one, h5py.Dataset) and one.dtype.kind in "fiucb":
            unit = next((one.attrs[name] for name in UNITS if name in one.attrs), "")
            found[with_unit(path.replace("/", "."), unit)] = one[()]

    with h5py.File(file, "r") as stream:
        stream.visititems(take)
    return table_of(file, KIND, found)
