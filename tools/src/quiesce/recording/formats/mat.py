"""MATLAB's files: version 4 to 7 by scipy, 7.3 (HDF5 inside) by pymatreader."""

from pathlib import Path
from typing import Any

from quiesce.base.extras import extra
from quiesce.recording.arrays import table_of
from quiesce.recording.table import Table

KIND = "MAT file"
HDF5 = b"\x89HDF\r\n\x1a\n"
USER_BLOCK = 512  # bytes before HDF5 begins, in files of MATLAB


def read(file: Path) -> Table:
    """Variables are columns, fields of structs 'struct.field', a matrix one a column of it."""
    with file.open("rb") as stream:
        start = stream.read(USER_BLOCK + len(HDF5))
    is_hdf5 = start.startswith(HDF5) or start[USER_BLOCK:] == HDF5
    found = _of_hdf5(file) if is_hdf5 else _of_scipy(file)
    own = {name: value for name, value in found.items() if not name.startswith(("__", "#"))}
    return table_of(file, KIND, own)


def _of_scipy(file: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    return loadmat(file, simplify_cells=True, appendmat=False)


def _of_hdf5(file: Path) -> dict[str, Any]:
    with extra("files", "a MAT file of version 7.3"):
        import h5py  # noqa: F401  # pymatreader asks for it later
        from pymatreader import read_mat

    return read_mat(str(file))
