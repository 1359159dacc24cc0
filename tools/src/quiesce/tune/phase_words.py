"""Tables of the phase law: the words that the firmware loads.

After the head: points of the first setting | points of the second << 16; unlock_current_mA; then
four for each point: freq_mHz | level_mA << 16, centre | width << 16 in 1/65536 of half a turn (a
width of 65535 is all of it), floor_mA | accel weight << 16 in 1/256, accel shape in 1/16384 |
ramp << 16 in 1/65536 of half a turn.
"""

from collections.abc import Sequence

from quiesce.base.table import format_table
from quiesce.table.kinds import PULSES
from quiesce.table.words import WORD, Reader, opened, sealed
from quiesce.tune.phase_table import FEWEST_POINTS, MOST_POINTS, SETTINGS, PhaseLaw, Point

HALF_TURN = 65_536
WEIGHT_ONE, SHAPE_ONE = 256, 16_384
POINT_WORDS = 4
HEAD = ("Hz||.3f", "centre||.2f deg", "width||.2f deg", "level||g A", "floor||g A", "ramp||.2f deg",
        "accel weight||.3g", "above||.3g")  # fmt: skip


def law_words(law: PhaseLaw) -> list[int]:
    """What the firmware loads."""
    tables = [law.settings[name] for name in SETTINGS]
    points = [point for table in tables for point in table]
    sizes = len(tables[0]) | len(tables[1]) << 16
    words = [word for point in points for word in _point_words(point)]
    return sealed(PULSES.magic, [sizes, law.unlock_current_mA, *words])


def _point_words(point: Point) -> tuple[int, ...]:
    centre = round(point.centre_deg / 180.0 * HALF_TURN) % HALF_TURN
    width = min(round(point.width_deg / 180.0 * HALF_TURN), HALF_TURN - 1)
    return (
        round(1e3 * point.freq_Hz) | point.level_mA << 16,
        centre | width << 16,
        point.floor_mA | round(WEIGHT_ONE * point.accel_weight) << 16,
        round(SHAPE_ONE * point.accel_shape) | round(point.ramp_deg / 180.0 * HALF_TURN) << 16,
    )


def law_of_words(words: Sequence[int]) -> PhaseLaw:
    """ValueError, in one line, where they are no table of pulses. What the numbers may be, the
    firmware checks."""
    reader = Reader([value % WORD for value in opened(words)])
    sizes, unlock_mA = reader.take(2)
    settings = {}
    for name, count in zip(SETTINGS, _halves(sizes), strict=True):
        if not FEWEST_POINTS <= count <= MOST_POINTS:
            raise ValueError(f"{count} points; a setting has {FEWEST_POINTS} .. {MOST_POINTS}")
        settings[name] = tuple(_point(reader.take(POINT_WORDS)) for _ in range(count))
    reader.end()
    return PhaseLaw("pulses", "a table", unlock_mA, settings)


def _halves(word: int) -> tuple[int, int]:
    return word & 0xFFFF, word >> 16


def _point(words: Sequence[int]) -> Point:
    freq_mHz, level_mA = _halves(words[0])
    centre, width = _halves(words[1])
    floor_mA, weight = _halves(words[2])
    shape, ramp = _halves(words[3])
    return Point(
        1e-3 * freq_mHz,
        180.0 * centre / HALF_TURN,
        180.0 if width == HALF_TURN - 1 else 180.0 * width / HALF_TURN,
        level_mA,
        floor_mA,
        weight / WEIGHT_ONE,
        shape / SHAPE_ONE,
        180.0 * ramp / HALF_TURN,
    )


def described_pulses(law: PhaseLaw) -> str:
    parts = [f"{1e-3 * law.unlock_current_mA:g} A while the phase is not known"]
    for name, points in law.settings.items():
        parts.append(f"setting {name}\n{format_table(HEAD, map(_row, points), ())}")
    return "\n\n".join(parts)


def _row(one: Point) -> tuple[float, ...]:
    return (
        one.freq_Hz, one.centre_deg, one.width_deg, 1e-3 * one.level_mA, 1e-3 * one.floor_mA,
        one.ramp_deg, one.accel_weight, one.accel_shape,
    )  # fmt: skip
