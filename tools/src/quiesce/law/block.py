"""Linear systems in integers: states that cannot leave their ranges, 24 bits a coefficient.

What a state can reach is its L1 norm: the sum over all ticks of the magnitude of its response to an
impulse of each input, times that input's limit. No input within its limits takes it further.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.signal

from quiesce.law.forms.linear import (
    MOST_ROW_SHIFT,
    MOST_STATE_SHIFT,
    STATE_LIMIT,
    LIMIT_mN,
    LinearTable,
    Row,
    State,
)
from quiesce.law.signal import COEFFICIENT_LIMIT, Input

CHUNK_TICKS = 2048
MOST_TICKS = 2**26  # 18 hours at 1 kHz: what rings longer is not bounded here
SMALL_TAIL = 1e-3  # of the sum: where the rest is bounded by a geometric series
SHARE = 0.5  # of a state's range that its norm is scaled to
WORST_CONDITION = 1e6  # of a change to real modal states


@dataclass(frozen=True)
class System:
    """x' = a x + b u, y = c x + d u, continuous, in SI units; y in N, a row of each."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray


@dataclass(frozen=True)
class Compiled:
    table: LinearTable
    headroom_dB: float  # of the fullest state, at all inputs' limits; inf without states
    pole_error: float  # largest distance of a pole's to its exact one, over its distance to 1
    gain_error: float  # largest difference of the constant gains, over the largest of the row


def compile_system(
    system: System, inputs: Sequence[Input], rows: Sequence[tuple[int, float]], rate_Hz: int
) -> Compiled:
    """rows: damper and limit in N of each row of y. ValueError, in one line, where the system is
    not stable, or its gains need more than there is."""
    a, b, c, d = discretized(system, rate_Hz)
    scale = np.array([one.per_unit for one in inputs])
    b, d, c = b / scale, 1e3 * d / scale, 1e3 * c
    largest = np.array([one.largest for one in inputs], dtype=float)
    if not len(a):
        table = LinearTable(rate_Hz, tuple(inputs), (), _rows(c, d, rows))
        return Compiled(table, np.inf, 0.0, _gain_error(table, a, b, c, d))
    a, b, c = _modal(a, b, c)
    reach = l1_norms(a, b * largest)
    size = SHARE * STATE_LIMIT / np.maximum(reach, np.finfo(float).tiny)
    a, b, c = size[:, None] * a / size, size[:, None] * b, c / size
    table = LinearTable(rate_Hz, tuple(inputs), _states(a, b), _rows(c, d, rows))
    real_a, real_b, _, _ = table.matrices()
    headroom = STATE_LIMIT / l1_norms(real_a, real_b * largest).max()
    if headroom < 1.0:
        raise ValueError("its states do not fit into 30 bits: a mode is too lightly damped")
    return Compiled(
        table,
        float(20 * np.log10(headroom)),
        _pole_error(a, real_a),
        _gain_error(table, a, b, c, d),
    )


def discretized(system: System, rate_Hz: int) -> tuple[np.ndarray, ...]:
    """With inputs that hold for a tick. ValueError where it is not strictly stable."""
    n = len(system.a)
    if n == 0:
        return np.zeros((0, 0)), np.zeros((0, system.d.shape[1])), system.c, system.d
    slowest = float(np.linalg.eigvals(system.a).real.max())
    if slowest >= 0:
        raise ValueError(f"not stable: a pole's real part is {slowest:.3g} 1/s")
    a, b, _, _, _ = scipy.signal.cont2discrete(
        (system.a, system.b, system.c, system.d), 1.0 / rate_Hz
    )
    return a, b, system.c, system.d


def _modal(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, ...]:
    """Real modal states where that is well conditioned: each pole's coefficients are its own."""
    values, vectors = np.linalg.eig(a)
    columns = []
    for value, vector in zip(values, vectors.T, strict=True):
        if abs(value.imag) < 1e-14:
            columns.append(vector.real)
        elif value.imag > 0:
            columns += [vector.real, vector.imag]
    change = np.array(columns).T
    if change.shape != a.shape or np.linalg.cond(change) > WORST_CONDITION:
        return a, b, c
    back = np.linalg.inv(change)
    return back @ a @ change, back @ b, c @ change


def l1_norms(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of each state, the sum over ticks and inputs of |A^k b|, never too small: what is left after
    the last tick is bounded by a geometric series. ValueError where it does not fade."""
    powers = [np.eye(len(a))]
    for _ in range(CHUNK_TICKS - 1):
        powers.append(powers[-1] @ a)
    stack = np.array(powers)
    over_chunk = powers[-1] @ a
    total = np.zeros(len(a))
    passed = np.eye(len(a))
    start = b
    for _ in range(MOST_TICKS // CHUNK_TICKS):
        total += np.abs(stack @ start).sum(axis=(0, 2))
        passed = over_chunk @ passed
        start = over_chunk @ start
        left = float(np.abs(passed).sum(axis=1).max())
        if left < SMALL_TAIL:
            # |A^(N+j) b| <= |A^N| max |A^j b| : the same sum again, times left, and so on.
            return total + total.max() * left / (1.0 - left)
    raise ValueError("a mode fades too slowly to be bounded")


def _shift_of(largest: float, most: int) -> int:
    """The largest shift that keeps a coefficient below 24 bits."""
    if largest == 0:
        return 0
    shift = int(np.floor(np.log2((COEFFICIENT_LIMIT - 1) / largest)))
    if shift < 0:
        raise ValueError(f"a gain of {largest:.3g} in units of the table is beyond 2^24")
    return min(shift, most)


def _integers(values: np.ndarray, most: int) -> tuple[int, tuple[int, ...]]:
    shift = _shift_of(float(np.abs(values).max()), most)
    return shift, tuple(int(value) for value in np.rint(np.ldexp(values, shift)))


def _states(a: np.ndarray, b: np.ndarray) -> tuple[State, ...]:
    change = np.hstack([a - np.eye(len(a)), b])
    return tuple(State(*_integers(row, MOST_STATE_SHIFT)) for row in change)


def _rows(c: np.ndarray, d: np.ndarray, rows: Sequence[tuple[int, float]]) -> tuple[Row, ...]:
    out = []
    for gains, (damper, limit_N) in zip(np.hstack([c, d]), rows, strict=True):
        shift, coefficients = _integers(gains, MOST_ROW_SHIFT)
        limit_mN = max(1, min(LIMIT_mN, round(1e3 * limit_N)))
        out.append(Row(damper, shift, limit_mN, coefficients))
    return tuple(out)


def _pole_error(exact: np.ndarray, real: np.ndarray) -> float:
    """Poles in the order of their angles; a pole's distance to 1 is how fast it is."""
    wanted, found = (np.sort_complex(np.linalg.eigvals(m)) for m in (exact, real))
    return float(np.max(np.abs(found - wanted) / np.abs(wanted - 1.0)))


def _gain_error(
    table: LinearTable, a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray
) -> float:
    def gains(m: tuple[np.ndarray, ...]) -> np.ndarray:
        n = len(m[0])
        return m[2] @ np.linalg.solve(np.eye(n) - m[0], m[1]) + m[3] if n else m[3]

    exact, real = gains((a, b, c, d)), gains(table.matrices())
    size = np.abs(exact).max(axis=1, keepdims=True)
    return float((np.abs(real - exact) / np.where(size > 0, size, 1.0)).max())
