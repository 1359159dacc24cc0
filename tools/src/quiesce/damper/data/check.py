"""What a recording must be before anything is fitted to it; hints are offered, never applied."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record
from quiesce.recording.table import Table, at, clipped
from quiesce.signal.recording import MAX_JITTER

MIN_ROWS = 50
GAP_PERIODS = 1.5
VERY_LATE_PERIODS = 5.0
ACCEPT = "if the values are right, --accept-values"


@dataclass(frozen=True)
class Piece:
    """Rows first .. end - 1 of a test, sampled evenly to `jitter` periods."""

    first: int
    end: int
    period_s: float
    jitter: float


# Time


def pieces_of(
    table: Table, lines: np.ndarray, time_s: np.ndarray, may_split: bool, may_be_uneven: bool
) -> list[Piece]:
    """Evenly sampled stretches of one test. UsageError, naming the line, where time is unsorted,
    repeats, has gaps (unless `may_split`) or is irregular (unless `may_be_uneven`)."""
    check_rows(table, lines)
    steps = np.diff(time_s)
    back = np.flatnonzero(steps < 0) + 1
    if back.size and not may_split:
        raise time_goes_back(table, lines, time_s, back)
    check_repeats(table, lines, time_s, steps)
    cuts = back
    if not all(is_even(time_s[a:b]) for a, b in spans(cuts, len(time_s))):
        gaps = gap_rows(steps)
        if gaps.size and not may_split and is_gap(time_s, steps, gaps):
            raise time_has_gap(table, lines, time_s, gaps)
        cuts = np.union1d(back, gaps) if may_split else back
    pieces = [
        even_piece(table, lines, time_s, a, b, may_be_uneven)
        for a, b in spans(cuts, len(time_s))
        if b - a >= MIN_ROWS
    ]
    if not pieces:
        raise at(
            table.file, int(lines[0]),
            f"no stretch between two gaps has {MIN_ROWS} rows; record without gaps",
        )  # fmt: skip
    return pieces


def check_rows(table: Table, lines: np.ndarray) -> None:
    if len(lines) >= MIN_ROWS:
        return
    line = int(lines[0]) if len(lines) else table.head_line
    raise at(
        table.file, line,
        f"{len(lines)} rows of data; a test needs at least {MIN_ROWS} (several periods of motion)",
    )  # fmt: skip


def spans(cuts: np.ndarray, count: int) -> list[tuple[int, int]]:
    edges = [0, *map(int, cuts), count]
    return list(zip(edges[:-1], edges[1:], strict=True))


def jitter_of(time_s: np.ndarray) -> float:
    """Largest distance of a time stamp from an even grid, in periods."""
    if len(time_s) < 3 or time_s[-1] <= time_s[0]:
        return 0.0
    period_s = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    return float(np.abs((time_s - time_s[0]) / period_s - np.arange(len(time_s))).max())


def is_even(time_s: np.ndarray) -> bool:
    return jitter_of(time_s) <= MAX_JITTER


def gap_rows(steps: np.ndarray) -> np.ndarray:
    """Rows that come late: more than GAP_PERIODS of the usual step after the one before."""
    usual = np.median(steps[steps > 0])
    return np.flatnonzero(steps > GAP_PERIODS * usual) + 1


def is_gap(time_s: np.ndarray, steps: np.ndarray, gaps: np.ndarray) -> bool:
    """Sampling is even between the late rows, or one of them is very late."""
    is_very_late = steps.max() > VERY_LATE_PERIODS * np.median(steps)
    return bool(is_very_late) or all(is_even(time_s[a:b]) for a, b in spans(gaps, len(time_s)))


def time_has_gap(
    table: Table, lines: np.ndarray, time_s: np.ndarray, gaps: np.ndarray
) -> UsageError:
    row = int(gaps[0])
    period_s = float(np.median(np.diff(time_s)))
    missing = round((time_s[row] - time_s[row - 1]) / period_s) - 1
    more = f", the first of {len(gaps)}" if len(gaps) > 1 else ""
    return at(
        table.file, int(lines[row]),
        f"a gap{more}: time jumps from {time_s[row - 1]:.6g} to {time_s[row]:.6g} s, "
        f"{missing} samples missing; --split-gaps makes separate records of the parts",
    )  # fmt: skip


def check_repeats(table: Table, lines: np.ndarray, time_s: np.ndarray, steps: np.ndarray) -> None:
    same = np.flatnonzero(steps == 0) + 1
    if not same.size:
        return
    hint = "drop the duplicate rows"
    if same.size > 0.05 * len(steps):
        hint = "if the stamps are rounded and sampling is even, --time none --rate-hz RATE"
    raise at(
        table.file, int(lines[same[0]]),
        f"the time {time_s[same[0]]:.6g} s repeats that of the row before ({same.size} such rows); "
        f"{hint}",
    )  # fmt: skip


def time_goes_back(
    table: Table, lines: np.ndarray, time_s: np.ndarray, back: np.ndarray
) -> UsageError:
    row = int(back[0])
    text = f"time goes back from {time_s[row - 1]:.6g} to {time_s[row]:.6g} s"
    edges = spans(back, len(time_s))
    if not all(starts_again(time_s, *pair) for pair in zip(edges, edges[1:], strict=False)):
        return at(table.file, int(lines[row]), f"{text}; sort the rows by time")
    columns = constant_within(table, set(lines.tolist()), edges)
    hint = f"--group {','.join(columns)}" if columns else "--split-gaps"
    return at(
        table.file, int(lines[row]),
        f"{text}: this looks like {len(edges)} tests one after the other; "
        f"{hint} makes a record of each",
    )  # fmt: skip


def starts_again(time_s: np.ndarray, one: tuple[int, int], other: tuple[int, int]) -> bool:
    """Both are long enough for a test, and time falls back by most of the first one's duration."""
    if min(one[1] - one[0], other[1] - other[0]) < MIN_ROWS:
        return False
    last_s = time_s[one[1] - 1]
    return bool(last_s - time_s[other[0]] > 0.5 * (last_s - time_s[one[0]]))


def constant_within(table: Table, lines: set[int], edges: list[tuple[int, int]]) -> list[str]:
    """A column that has one value in each test and another in every test, else all columns that
    are constant in each test; of the rows `lines`."""
    cells = list(zip(*(row for line, row in table.rows() if line in lines), strict=True))
    steady = {}
    for name, column in zip(table.head, cells, strict=True):
        if name and all(len(set(column[a:b])) == 1 for a, b in edges) and len(set(column)) > 1:
            steady[name] = [column[a] for a, _ in edges]
    for name, values in steady.items():
        if len(set(values)) == len(values):
            return [name]
    return list(steady)


def even_piece(
    table: Table, lines: np.ndarray, time_s: np.ndarray, first: int, end: int, may_be_uneven: bool
) -> Piece:
    part = time_s[first:end]
    period_s = float(part[-1] - part[0]) / (len(part) - 1)
    jitter = jitter_of(part)
    if jitter > MAX_JITTER and not may_be_uneven:
        row = first + 1 + int(np.argmax(np.abs(np.diff(part) - period_s)))
        raise at(
            table.file, int(lines[row]),
            f"sampling is irregular: time advances by {time_s[row] - time_s[row - 1]:.6g} s where "
            f"the mean is {period_s:.6g} s; --work-rate-hz RATE interpolates onto even times",
        )  # fmt: skip
    return Piece(first, end, period_s, jitter)


# Values


@dataclass(frozen=True)
class Range:
    """Where a quantity of a damper test plausibly lies; zero is judged elsewhere."""

    what: str
    unit: str
    least: float
    most: float
    measure: Callable[[Record], float]
    columns: str


def half_span(values: np.ndarray) -> float:
    return float(np.ptp(values)) / 2.0


def stiffness_N_m(record: Record) -> float:
    travel_m = half_span(record.disp_m)
    return half_span(record.force_N) / travel_m if travel_m > 0.0 else 0.0


# From finger-sized dampers and squeeze-mode mounts to seismic ones of several MN.
RANGES = (
    Range(
        "the displacement (half its span)", "m", 1e-5, 1.5,
        lambda r: half_span(r.disp_m), "displacement or velocity",
    ),
    Range(
        "the speed (its largest value)", "m/s", 2e-4, 15.0,
        lambda r: float(np.abs(r.velocity_m_s).max()), "motion or time",
    ),
    Range("the force (half its span)", "N", 2.0, 5e6, lambda r: half_span(r.force_N), "force"),
    Range(
        "force over displacement (of their half spans)", "N/m", 10.0, 5e7,
        stiffness_N_m, "force or displacement",
    ),
    Range(
        "the current (its largest value)", "A", 5e-3, 30.0,
        lambda r: float(np.abs(r.command).max()) if r.command_unit == "A" else 0.0, "current",
    ),
    Range(
        "the voltage (its largest value)", "V", 5e-3, 400.0,
        lambda r: float(np.abs(r.command).max()) if r.command_unit == "V" else 0.0, "command",
    ),
)  # fmt: skip


RATE_Hz = (5.0, 1e5)
RATE_LIMIT_Hz = (0.05, 1e7)


def check_rate(where: str, rate_Hz: float, accepted: bool) -> None:
    least, most = RATE_LIMIT_Hz if accepted else RATE_Hz
    if least <= rate_Hz <= most:
        return
    hint = "" if accepted else f"; {ACCEPT}"
    raise UsageError(
        f"{where}: sampled at {rate_Hz:.3g} Hz (expected {least:g} .. {most:g}); is the unit of "
        f"time right? State it as --time NAME:UNIT{hint}"
    )


def check_ranges(where: str, record: Record) -> None:
    """UsageError for a value that points to a wrong unit."""
    for item in RANGES:
        value = item.measure(record)
        if value == 0.0 or item.least <= value <= item.most:
            continue
        side = "small" if value < item.least else "large"
        raise UsageError(
            f"{where}: {item.what} is implausibly {side}, {value:.3g} {item.unit} (expected "
            f"{item.least:g} .. {item.most:g}); is the unit of {item.columns} right? State it as "
            f"NAME:UNIT; {ACCEPT}"
        )


def check_constant(table: Table, line: int, role: str, name: str, values: np.ndarray) -> None:
    """Motion and force must move."""
    if np.ptp(values) > 0.0:
        return
    raise at(
        table.file, line,
        f"column '{clipped(name)}' ({role}) is constant, {values[0]:.6g} throughout the test; "
        f"name another with --{role}, or drop the test",
    )  # fmt: skip


def motion_agreement(velocity_m_s: np.ndarray, derivative_m_s: np.ndarray) -> tuple[float, float]:
    """Gain of a measured velocity over dx/dt (least squares), and their correlation."""
    across = float(velocity_m_s @ derivative_m_s)
    power = float(derivative_m_s @ derivative_m_s)
    both = np.sqrt(power * float(velocity_m_s @ velocity_m_s))
    return (across / power, across / both) if min(both, power) > 0.0 else (0.0, 0.0)


def check_velocity(where: str, gain: float, correlation: float, used: bool) -> None:
    """A measured velocity that is dx/dt but for a power of ten, or for its sign where it is used,
    has a wrong unit or sign."""
    if abs(correlation) < 0.8:
        return
    power = round(float(np.log10(abs(gain))))
    if power != 0 and abs(abs(gain) / 10.0**power - 1.0) < 0.2:
        raise UsageError(
            f"{where}: the measured velocity is {gain:.3g} times dx/dt; one unit of displacement, "
            "velocity or time is wrong by a power of ten: state it as NAME:UNIT, or leave the "
            "velocity out with --velocity none"
        )
    if used and gain < 0.0:
        raise UsageError(
            f"{where}: the measured velocity has the opposite sign of dx/dt; leave out "
            "--use-velocity, or turn it with --velocity NAME:-1*UNIT"
        )


# A damper absorbs energy. Elastic forces and noise leave this correlation near zero.
OPPOSITE = -0.05
HARDLY = 0.05


def check_energy(where: str, record: Record, flipped: bool) -> str | None:
    """UsageError where the force gives energy to the motion; a note where it hardly takes any."""
    force_N = record.force_N - record.force_N.mean()
    velocity_m_s = record.velocity_m_s - record.velocity_m_s.mean()
    energy_J = float(force_N @ velocity_m_s) / record.rate_Hz
    size = float(np.linalg.norm(force_N) * np.linalg.norm(velocity_m_s)) / record.rate_Hz
    correlation = energy_J / size if size > 0.0 else 0.0
    if correlation < OPPOSITE:
        hint = "leave out --flip-force" if flipped else "--flip-force turns the force"
        hint += (
            ", or, where force and displacement are interchanged, --force and --displacement "
            "name them"
        )
        raise UsageError(
            f"{where}: the force gives {-energy_J:.3g} J to the motion over the test where a "
            f"damper absorbs energy (correlation with velocity {correlation:.2f}); it has the "
            f"opposite sign: {hint}"
        )
    if correlation < HARDLY:
        return (
            f"force and velocity are hardly related (correlation {correlation:.2f}): a test "
            "without damping, or channels that are shifted in time"
        )
    return None
