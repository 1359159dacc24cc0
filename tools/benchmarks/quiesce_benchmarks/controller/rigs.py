"""Boards and what their sensors deliver, made up for measurements."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

# A sample that does not come, in the bench's files of counts.
NO_SAMPLE = np.iinfo(np.int32).min

# What a sensor measures: key of its scale, whether it is a body's.
SENSES = {
    "acceleration": ("scale_um_s2", True),
    "velocity": ("scale_um_s", True),
    "displacement": ("scale_nm", True),
    "stroke": ("scale_nm", False),
    "stroke_velocity": ("scale_um_s", False),
    "force": ("scale_mN", False),
    "coil_voltage": ("scale_mV", False),
    "temperature": ("scale_mdegC", False),
}
FULL_SCALE = 8388607


@dataclass(frozen=True)
class Sensor:
    measures: str
    of: int  # body or damper
    scale: float
    period_us: int = 0
    polarity: int = 1
    max_lost_pct: int = 100


@dataclass(frozen=True)
class Damper:
    end_a: int  # body
    end_b: int | None  # None: the ground
    ceiling_mA: int = 5000
    safe_mA: int = 0


@dataclass(frozen=True)
class Board:
    bodies: int
    sensors: Sequence[Sensor]  # the first one is an accelerometer, and tracked
    dampers: Sequence[Damper]

    def text(self) -> str:
        """The board file."""
        names = ", ".join(f'"body{i}"' for i in range(self.bodies))
        head = f'schema = "quiesce-board"\nversion = 1\nname = "made_up"\nbodies = [{names}]\n'
        sensors = [sensor_text(i, one) for i, one in enumerate(self.sensors)]
        dampers = [damper_text(i, one) for i, one in enumerate(self.dampers)]
        return "\n".join([head, *sensors, *dampers])


def sensor_text(index: int, sensor: Sensor) -> str:
    scale_key, is_of_body = SENSES[sensor.measures]
    owner = "body" if is_of_body else "damper"
    return f"""[[sensor]]
name = "sensor{index}"
measures = "{sensor.measures}"
of = "{owner}{sensor.of}"
{scale_key} = {sensor.scale}
full_scale_counts = {FULL_SCALE}
period_us = {sensor.period_us}
max_age_us = {max(10000, 4 * sensor.period_us)}
polarity = {sensor.polarity}
max_lost_pct = {sensor.max_lost_pct}
stuck_us = 0
"""


def damper_text(index: int, damper: Damper) -> str:
    end_b = "ground" if damper.end_b is None else f"body{damper.end_b}"
    return f"""[[damper]]
name = "damper{index}"
end_a = "body{damper.end_a}"
end_b = "{end_b}"
ceiling_mA = {damper.ceiling_mA}
safe_mA = {damper.safe_mA}
"""


def random_board(rng: np.random.Generator) -> Board:
    """Any that the largest build serves, with the first sensor an accelerometer."""
    bodies = int(rng.integers(1, 5))
    dampers = [random_damper(rng, bodies) for _ in range(rng.integers(1, 5))]
    places = [
        (name, of)
        for name, (_, is_of_body) in SENSES.items()
        for of in range(bodies if is_of_body else len(dampers))
    ]
    first = ("acceleration", int(rng.integers(bodies)))
    places.remove(first)
    more = rng.permutation(len(places))[: rng.integers(0, 8)]
    sensors = [random_sensor(rng, *places[i]) for i in more]
    return Board(bodies, [Sensor(*first, 57.751), *sensors], dampers)


def random_damper(rng: np.random.Generator, bodies: int) -> Damper:
    end_a = int(rng.integers(bodies))
    others = [i for i in range(bodies) if i != end_a]
    end_b = int(rng.choice(others)) if others and rng.random() < 0.5 else None
    ceiling_mA = int(rng.integers(500, 5001))
    return Damper(end_a, end_b, ceiling_mA, int(rng.integers(0, ceiling_mA // 2)))


def random_sensor(rng: np.random.Generator, measures: str, of: int) -> Sensor:
    return Sensor(
        measures,
        of,
        scale=float(rng.integers(1, 60)),  # full scale within 500 m/s2
        period_us=int(rng.choice([0, 0, 2000, 5000, 12345])),
        polarity=int(rng.choice([-1, 1])),
        max_lost_pct=int(rng.choice([50, 100])),
    )


def random_counts(
    rng: np.random.Generator, sensors: int, ticks: int, lost: float = 0.01
) -> np.ndarray:
    """[ticks, sensors] int32: tones, noise, steps and now and then no sample or full scale."""
    time = np.arange(ticks)[:, None]
    amplitude = FULL_SCALE / 2.0 ** rng.uniform(1, 14, sensors)
    turns = rng.uniform(0.003, 0.03, sensors) * time + rng.random(sensors)
    values = amplitude * np.sin(2 * np.pi * turns)
    values += amplitude * 0.05 * rng.standard_normal((ticks, sensors))
    values += np.where(time > ticks // 2, rng.uniform(-1, 1, sensors) * amplitude, 0.0)
    counts = np.clip(np.rint(values), -FULL_SCALE, FULL_SCALE).astype(np.int32)
    chance = rng.random((ticks, sensors))
    counts[chance < lost / 10] = FULL_SCALE
    counts[chance > 1 - lost] = NO_SAMPLE
    return counts


def write_rig(folder: Path, board: Board, counts: np.ndarray) -> list[str]:
    """Options of the bench's replay for them."""
    board_file, counts_file = folder / "board.toml", folder / "counts.i32"
    board_file.write_text(board.text(), encoding="utf-8")
    counts_file.write_bytes(np.ascontiguousarray(counts, dtype="<i4").tobytes())
    return ["--board", str(board_file), "--counts", str(counts_file)]
