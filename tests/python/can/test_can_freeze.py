"""`quiesce can freeze` beside a real controller: the firmware in a process, SLCAN on a pty."""

import csv
import json
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import can
import pytest
from can_bus import Controller, build_peer
from conftest import Result, run_quiesce
from quiesce.can.database import load
from quiesce.can.fault_record import (
    SIGNALS,
    Collector,
    WrongRecord,
    csv_lines,
    record_of,
)

DATABASE = load()
PAGES = 318


@pytest.fixture(scope="session")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("can_peer"))


@pytest.fixture
def controller(peer: Path, tmp_path: Path) -> Iterator[Controller]:
    one = Controller(peer, tmp_path)
    yield one
    one.stop()


@pytest.fixture
def tool(tmp_path: Path, controller: Controller):
    def run(*arguments: str | Path) -> Result:
        return run_quiesce(tmp_path, "can", *arguments, "--bus", controller.bus)

    return run


def rows_of(folder: Path) -> list[dict[str, str]]:
    with (folder / "record.csv").open() as file:
        return list(csv.DictReader(file))


def check_stop(folder: Path) -> None:
    """The record of an emergency stop while the controller ran on a sine of 8 Hz."""
    figures = json.loads((folder / "record.json").read_text())
    assert (figures["fault"], figures["interface_version"]) == ("ESTOP", 3)
    assert figures["tick_rate_Hz"] == 1000 and figures["table_hash"] != "00000000"
    rows = rows_of(folder)
    assert len(rows) == 58 and float(rows[50]["time_s"]) == 0.0
    assert float(rows[0]["time_s"]) == -1.0
    after = [int(row["state_max"]) for row in rows[51:]]
    assert after == [4] * 7  # FAULT, driver off
    for row in rows[51:]:
        assert float(row["current_meas_A_min"] or 0) == 0.0
    swing = max(float(row["accel_m_s2_max"]) for row in rows[1:50] if row["accel_m_s2_max"])
    assert swing > 0.01
    assert (folder / "record.png").read_bytes().startswith(b"\x89PNG")
    data = (folder / "record.bin").read_bytes()
    assert zlib.crc32(data[:-4]) == int.from_bytes(data[-4:], "little")


def test_freeze_writes_the_second_before_a_stop(controller: Controller, tool, tmp_path) -> None:
    controller.start()
    assert tool("monitor", "--seconds", "2").returncode == 0  # a second of history
    assert tool("stop", "--yes").returncode == 0
    result = tool("freeze", "--out", tmp_path / "one")
    assert result.returncode == 0, result.stderr
    assert "fault     ESTOP in state" in result.stdout
    assert f"{PAGES} of {PAGES} pages" in result.stderr
    check_stop(tmp_path / "one")
    # It stays, until it is cleared.
    result = tool("freeze", "--out", tmp_path / "two", "--clear", "--json")
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout)["later_faults"] == 0
    one, two = ((tmp_path / name / "record.bin").read_bytes() for name in ("one", "two"))
    assert one == two
    result = tool("freeze", "--out", tmp_path / "three")
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr.splitlines() == [
        f"quiesce: {controller.bus}: the controller has no fault record"
    ]
    assert not (tmp_path / "three").exists()


def test_freeze_asks_again_for_lost_pages(controller: Controller, tool, tmp_path: Path) -> None:
    controller.start("--drop", "7")
    assert tool("stop", "--yes").returncode == 0
    result = tool("freeze", "--out", tmp_path / "out")
    assert result.returncode == 0, result.stderr
    assert len(rows_of(tmp_path / "out")) == 58


def test_freeze_without_a_record_or_a_controller(controller: Controller, tool) -> None:
    controller.start()
    assert "has no fault record" in tool("freeze").stderr
    controller.stop()
    controller.start("--silent")
    result = tool("freeze")
    assert result.returncode == 1 and "no controller answers" in result.stderr
    assert result.stderr.count("\n") == 1


# Records and pages that are wrong


def sealed(data: bytes) -> bytes:
    return data + struct.pack("<I", zlib.crc32(data))


def a_record(fault_bin: int = 50, count: int = 58, bins: int = 58) -> bytes:
    head = b"QFR1" + bytes([10, 130, fault_bin, count]) + struct.pack("<I2H", 7, 20, 1000)
    head += struct.pack("<2I4BIi2IHBB", 1, 2, 0, 1, 0, 3, 1, -5, 0, 0, 4, 3, 0)
    return sealed(head + struct.pack("<hh", -1, 2) * (8 * bins - 1) + b"\xff\x7f\x00\x80")


def test_a_record_is_read() -> None:
    record = record_of(a_record())
    assert (record.fault, record.state_before, record.number, record.law) == (10, 2, 4, 3)
    assert record.is_latched
    assert (record.accel_counts, record.version, record.interface_version) == (-5, "0.1.0", 3)
    assert record.bins[0] == ((-1, 2),) * 8 and record.bins[57][7] is None
    lines = list(csv_lines(record))
    assert len(lines) == 59 and lines[1].startswith("-1.00,-0.002,0.004,-0.01,0.02,")
    assert lines[-1].endswith("0.002,,")
    assert lines[0].count(",") == 2 * len(SIGNALS)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "no fault record"),
        (b"QFR1", "no fault record"),
        (sealed(b"QFR2" + bytes(2000)), "no fault record"),
        (a_record()[:-1] + b"\x00", "CRC"),
        (a_record(bins=57), "57 bins instead of 58"),
        (a_record(fault_bin=58), "the fault in 58"),
        (sealed(b"QFR1" + bytes(44)), "0 bins instead of 0"),
    ],
)
def test_a_wrong_record_is_refused(data: bytes, words: str) -> None:
    with pytest.raises(WrongRecord, match=words):
        record_of(data)


def page(number: int, of: int, length: int = 8) -> can.Message:
    data = struct.pack("<H", number | of << 12) + bytes([number & 0xFF] * 6)
    return can.Message(arbitration_id=0x181, is_extended_id=False, data=data[:length])


def test_pages_of_two_records_are_never_put_together() -> None:
    collector = Collector(DATABASE)
    collector.total = 4
    for number in (0, 1, 3):
        collector.take(page(number, of=1))
    assert collector.missing() == (2, 1)
    collector.take(page(2, of=1, length=7))  # malformed
    collector.take(page(4000, of=1))  # no such page
    assert collector.missing() == (2, 1)
    collector.take(page(2, of=2))
    assert collector.missing() == (0, 2)
    for number in (0, 1, 3):
        collector.take(page(number, of=2))
    assert collector.missing() is None and len(collector.data()) == 24
