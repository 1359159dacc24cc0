"""Tables of law `linear`: a linear system from signals to forces.

firmware/law/forms/law_linear.c and firmware/base/state_space.h describe the words.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.law.sections import limited
from quiesce.law.signal import Input, Signal, read_coefficients, read_input
from quiesce.table.kinds import LINEAR
from quiesce.table.words import Reader, opened, sealed

MAGIC = LINEAR.magic
MOST_STATES, MOST_INPUTS, MOST_ROWS = 12, 12, 8
MOST_STATE_SHIFT, MOST_ROW_SHIFT = 46, 62
LIMIT_mN = 2**30 - 1
STATE_LIMIT = 2**30 - 1


@dataclass(frozen=True)
class State:
    """What changes it in a tick: coefficients of all states and inputs, in units of 2^-shift."""

    shift: int
    coefficients: tuple[int, ...]


@dataclass(frozen=True)
class Row:
    """Part of a damper's force, limited by itself: coefficients of all states and inputs."""

    damper: int
    shift: int
    limit_mN: int
    coefficients: tuple[int, ...]


@dataclass(frozen=True)
class LinearTable:
    rate_Hz: int  # ticks a second that it is made for
    inputs: tuple[Input, ...]
    states: tuple[State, ...]
    rows: tuple[Row, ...]

    law = "linear"
    demands = "force"

    def signals(self) -> list[Signal]:
        return [one.signal for one in self.inputs]

    def dampers(self) -> set[int]:
        return {row.damper for row in self.rows}

    def words(self) -> list[int]:
        """ValueError where there is too much of it."""
        _require_sizes(len(self.states), len(self.inputs), len(self.rows))
        values = [self.rate_Hz, len(self.states), len(self.inputs), len(self.rows)]
        for one in self.inputs:
            values += one.words()
        for state in self.states:
            values += [state.shift, *state.coefficients]
        for row in self.rows:
            values += [row.damper, row.shift, row.limit_mN, *row.coefficients]
        return sealed(MAGIC, values)

    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """A [n n], B [n m], C [q n], D [q m] of x(k+1) = A x + B u, in the table's own units: what
        the integers stand for."""
        n, m = len(self.states), len(self.inputs)
        change = np.array(
            [np.array(state.coefficients) * 2.0**-state.shift for state in self.states]
        ).reshape(n, n + m)
        out = np.array([np.array(row.coefficients) * 2.0**-row.shift for row in self.rows])
        return np.eye(n) + change[:, :n], change[:, n:], out[:, :n], out[:, n:]

    def forces_N(self, values: np.ndarray) -> np.ndarray:
        """Of each damper [ticks 4] for signals [ticks m] in SI units, in float64."""
        a, b, c, d = self.matrices()
        u = limited(self.inputs, values)
        x = np.zeros(len(self.states))
        out = np.zeros((len(values), 4))
        limits = np.array([row.limit_mN for row in self.rows])
        for tick, now in enumerate(u):
            parts = np.clip(c @ x + d @ now, -limits, limits)
            for row, part in zip(self.rows, parts, strict=True):
                out[tick, row.damper] += 1e-3 * part
            x = a @ x + b @ now
        return out


def _require_sizes(states: int, inputs: int, rows: int) -> None:
    if not (0 <= states <= MOST_STATES and 1 <= inputs <= MOST_INPUTS and 1 <= rows <= MOST_ROWS):
        raise ValueError(
            f"{states} states, {inputs} inputs and {rows} rows; there may be {MOST_STATES}, "
            f"1 .. {MOST_INPUTS} and 1 .. {MOST_ROWS}"
        )


def read(words: Sequence[int]) -> LinearTable:
    """ValueError, in one line, where the firmware refuses them."""
    reader = Reader(opened(words))
    rate_Hz, n, m, q = reader.take(4)
    _require_sizes(n, m, q)
    inputs = tuple(read_input(reader) for _ in range(m))
    states = tuple(
        State(reader.one(0, MOST_STATE_SHIFT, "shift"), read_coefficients(reader, n + m))
        for _ in range(n)
    )
    rows = tuple(
        Row(
            reader.one(0, 3, "damper"),
            reader.one(0, MOST_ROW_SHIFT, "shift"),
            reader.one(1, LIMIT_mN, "limit"),
            read_coefficients(reader, n + m),
        )
        for _ in range(q)
    )
    reader.end()
    return LinearTable(rate_Hz, inputs, states, rows)
