"""The firmware's own laws, compiled here, on signals in SI units."""

import ctypes
import subprocess
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
from quiesce.base.paths import root
from quiesce.law.tables import Table

LAWS = ("linear", "signs", "friction", "polynomial")
DAMPERS = 4
NO_DEMAND = 2**31 - 1


@cache
def library() -> ctypes.CDLL:
    firmware = root() / "firmware"
    file = Path(mkdtemp(prefix="quiesce-laws-")) / "laws.so"
    sources = [firmware / "base" / f"{one}.c" for one in ("sections", "state_space", "table", "view_signal")]
    sources += [firmware / "base/crc32.c", *sorted((firmware / "law/forms").glob("*.c"))]
    sources.append(Path(__file__).with_name("law_steps.c"))
    subprocess.run(
        ["cc", "-std=c11", "-O1", "-fno-strict-aliasing", "-shared", "-fPIC", "-o", file]
        + ["-DQUIESCE_SENSORS=8", "-DQUIESCE_BODIES=4", "-DQUIESCE_DAMPERS=4"]
        + [f"-I{firmware / one}" for one in ("include", "base", "law")]
        + sources,
        check=True,
    )
    return ctypes.CDLL(str(file))


def verdict(law: str, words: list[int]) -> int:
    return _call(law, words, np.zeros(0, np.uint32), np.zeros((0, 0), np.int32))[0]


def demands(table: Table, values: np.ndarray) -> np.ndarray:
    """[ticks 4] in N or A for signals [ticks, as table.signals()] in SI units; NaN: no demand."""
    signals = table.signals()
    units = np.array([one.quantity.per_unit for one in signals])
    words = np.array([one.word for one in signals], np.uint32)
    said, out = _call(table.law, table.words(), words, np.rint(values * units).astype(np.int32))
    assert said == 0, said
    return np.where(out == NO_DEMAND, np.nan, 1e-3 * out)


def _call(
    law: str, words: list[int], signals: np.ndarray, values: np.ndarray
) -> tuple[int, np.ndarray]:
    table = np.array(words, np.uint32)
    values = np.ascontiguousarray(values, np.int32)
    out = np.zeros((len(values), DAMPERS), np.int32)

    def at(one: np.ndarray) -> ctypes.c_void_p:
        return one.ctypes.data_as(ctypes.c_void_p)

    said = library().law_steps(
        LAWS.index(law), at(table), len(table), at(signals), len(signals), at(values),
        len(values), at(out),
    )  # fmt: skip
    return said, out
