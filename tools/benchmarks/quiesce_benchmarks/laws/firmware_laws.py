"""The firmware's own laws, compiled here, on signals in SI units."""

import ctypes
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
from quiesce.base.paths import root
from quiesce.law.forms.network import NetworkTrackTable
from quiesce.law.signal import Quantity
from quiesce.law.tables import Table

FOLDERS = ("base", "fuzzy", "law", "param", "plants", "track")
DAMPERS = 4
NO_DEMAND = 2**31 - 1


@cache
def library() -> ctypes.CDLL:
    firmware = root() / "firmware"
    file = Path(mkdtemp(prefix="quiesce-laws-")) / "laws.so"
    sources = [file for one in FOLDERS for file in sorted((firmware / one).rglob("*.c"))]
    headers = {file.parent for one in FOLDERS for file in (firmware / one).rglob("*.h")}
    sources += [Path(__file__).with_name(one) for one in ("law_steps.c", "track_steps.c")]
    subprocess.run(
        ["cc", "-std=c11", "-O1", "-fno-strict-aliasing", "-shared", "-fPIC", "-o", file]
        + ["-DQUIESCE_SENSORS=8", "-DQUIESCE_BODIES=4", "-DQUIESCE_DAMPERS=4"]
        + [f"-I{one}" for one in (firmware / "include", *sorted(headers))]
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

    said = library().law_steps(
        law.encode(), _at(table), len(table), _at(signals), len(signals), _at(values),
        len(values), _at(out),
    )  # fmt: skip
    return said, out


def _at(one: np.ndarray) -> ctypes.c_void_p:
    return one.ctypes.data_as(ctypes.c_void_p)


class Tracker:
    """The tracker that works with these words, for one damper, from rest; its inputs are these
    quantities of the damper, the demand among them."""

    STATE_BYTES = 1024

    def __init__(self, words: list[int], inputs: Sequence[Quantity], damper: int = 0) -> None:
        self._words = np.array(words, np.uint32)
        self._damper = damper
        self._units = np.array([one.per_unit for one in inputs])
        self._signals = np.array([one.code for one in inputs], np.uint32)
        self._state = np.zeros(self.STATE_BYTES, np.uint8)

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        """[ticks] for its inputs [ticks, inputs] in SI units."""
        units = np.ascontiguousarray(np.rint(values * self._units), np.int32)
        out = np.zeros(len(values), np.int32)
        said = library().track_steps(
            _at(self._words), len(self._words), self._damper, _at(self._state),
            _at(self._signals), len(self._signals), _at(units), len(units), _at(out),
        )  # fmt: skip
        assert said == 0, said
        return 1e-3 * out


class NetworkTracker(Tracker):
    def __init__(self, table: NetworkTrackTable, damper: int = 0) -> None:
        inputs = [one.signal.quantity for one in table.sections[damper].inputs]
        super().__init__(table.words(), inputs, damper)


def tracker_verdict(words: list[int]) -> int:
    table, none = np.array(words, np.uint32), np.zeros(1, np.int32)
    return library().track_steps(
        _at(table), len(table), 0, _at(none), _at(none), 0, _at(none), 0, _at(none)
    )
