"""Malformed and contradictory board files, and how many of them the bench refuses in one line."""

import subprocess
import tempfile
import tomllib
from collections.abc import Callable
from pathlib import Path

from quiesce.base.errors import EXIT_BAD_INPUT
from quiesce.engine.bench import Bench

HERE = Path(__file__).parent
GOOD = HERE / "every_key.toml"

# What becomes of a good file: (what it has once, what takes its place), or any other bytes.
Edit = tuple[str, str] | Callable[[bytes], bytes]

SENSOR = """
[[sensor]]
name = "more{0}"
measures = "velocity"
of = "floor"
scale_um_s = 1
full_scale_counts = 1000
"""
DAMPER = """
[[damper]]
name = "more{0}"
end_a = "floor"
end_b = "ground"
ceiling_mA = 1000
safe_mA = 0
"""


def with_more(table: str, count: int) -> Edit:
    return lambda good: good + "".join(table.format(i) for i in range(count)).encode()


def without(table: str) -> Edit:
    """Without all [[table]]."""

    def cut(good: bytes) -> bytes:
        head, *parts = good.decode().split("\n[[")
        return "\n[[".join([head, *(p for p in parts if not p.startswith(table))]).encode()

    return cut


# What no exchange of one text for another makes.
DAMAGES: list[tuple[str, Edit, str]] = [
    ("empty", lambda good: b"", "schema: missing"),
    ("blank", lambda good: b"\n \n", "schema: missing"),
    ("zero_bytes", lambda good: bytes(300), "Error while parsing"),
    ("noise", lambda good: bytes(range(256)) * 4, "rror"),
    ("not_utf_8", lambda good: good.replace(b"floor_accel", b"fl\xf6\xf6r_accel"), "utf-8"),
    ("utf_16", lambda good: good.decode().encode("utf-16"), "utf-8"),
    ("cut", lambda good: good[: len(good) // 2 - 2], "end-of-file"),
    ("twice", lambda good: good + good, "Error while parsing"),
    ("deep", lambda good: b"deep = " + b"[" * 100_000 + b"\n" + good, "nested"),
    ("long_line", lambda good: b"#" + good.replace(b"\n", b" ") * 100, "schema: missing"),
    ("json", lambda good: b'{"schema": "quiesce-board"}', "Error while parsing"),
    ("no_sensors", without("sensor"), "sensor: this build serves 1 .. 8 sensors, found 0"),
    ("no_dampers", without("damper"), "damper: this build serves 1 .. 4 dampers, found 0"),
    ("nine_sensors", with_more(SENSOR, 4), "sensor: this build serves 1 .. 8 sensors, found 9"),
    ("many_sensors", with_more(SENSOR, 995), "this build serves 1 .. 8 sensors, found 1000"),
    ("five_dampers", with_more(DAMPER, 3), "damper: this build serves 1 .. 4 dampers, found 5"),
]


def read_cases() -> list[tuple[str, Edit, str]]:
    with (HERE / "boards.toml").open("rb") as file:
        cases = tomllib.load(file)["cases"]
    return [(name, (old, new), expected) for name, (old, new, expected) in cases.items()]


# Name, edit, part of the message.
CASES: list[tuple[str, Edit, str]] = read_cases() + DAMAGES


def spoilt(good: bytes, edit: Edit) -> bytes:
    if callable(edit):
        return edit(good)
    old, new = (text.encode() for text in edit)
    if good.count(old) != 1:
        raise ValueError(f"the good board has {good.count(old)} times: {edit[0]}")
    return good.replace(old, new)


def is_refused(bench: Bench, file: Path, expected: str) -> bool:
    """In one line that names the file and says what is expected of it."""
    exe = [str(bench.executable), "board-check", str(file)]
    result = subprocess.run(exe, stdin=subprocess.DEVNULL, capture_output=True, timeout=60)
    message = result.stderr.decode(errors="replace")
    return (
        result.returncode == EXIT_BAD_INPUT
        and result.stdout == b""
        and message.startswith(f"quiesce_bench: {file}:")
        and message.count("\n") == 1
        and message.endswith("\n")
        and expected in message
    )


def refused(bench: Bench) -> tuple[int, int]:
    """How many files were tried, and how many of them were refused in one line."""
    good = GOOD.read_bytes()
    bench.call("board-check", str(GOOD))  # or everything would be refused
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "board.toml"
        results = [
            is_refused(bench, file, "cannot be read"),
            is_refused(bench, Path(folder), "is a folder"),
        ]
        for _, edit, expected in CASES:
            file.write_bytes(spoilt(good, edit))
            results.append(is_refused(bench, file, expected))
    return len(results), sum(results)
