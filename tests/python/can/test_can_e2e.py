"""Alive counters and CRCs in Python against the rules of firmware/comm/e2e.h."""

import pytest
from quiesce.can.database import load
from quiesce.can.e2e import JUMPED, OK, REPEATED, WRONG_CRC, WRONG_SHAPE, Receiver, crc8, protect

DATABASE = load()
PROTECTED = [one for one in DATABASE.messages if one.protection]


def frame(name: str, alive: int, **signals: int) -> bytes:
    layout = DATABASE.by_name[name].protection
    assert layout is not None
    return protect(layout, alive, DATABASE.encode(name, **signals))


def receiver(name: str) -> Receiver:
    layout = DATABASE.by_name[name].protection
    assert layout is not None
    return Receiver(layout)


def test_crc_has_the_check_value_of_sae_j1850() -> None:
    assert crc8(b"123456789") == 0x4B
    assert crc8(b"") == 0x00


def test_the_safety_relevant_messages_are_protected() -> None:
    names = {one.name for one in PROTECTED}
    assert {"CurrentDemand", "EmergencyStop", "Status", "ServiceRequest"} <= names
    assert "Motion" not in names


@pytest.mark.parametrize("message", PROTECTED, ids=lambda one: one.name)
def test_protection_keeps_the_other_signals(message) -> None:
    assert message.protection.length == message.length
    for alive in range(16):
        before = DATABASE.raw(message.frame_id, DATABASE.encode(message.name))
        data = frame(message.name, alive)
        after = DATABASE.raw(message.frame_id, data)
        assert after["alive"] == alive and after["crc"] == data[-1]
        kept = {key for key in before if key not in ("alive", "crc")}
        assert all(before[key] == after[key] for key in kept)


@pytest.mark.parametrize("message", PROTECTED, ids=lambda one: one.name)
def test_every_flipped_bit_is_seen(message) -> None:
    data = frame(message.name, 5)
    for bit in range(8 * message.length):
        flipped = bytearray(data)
        flipped[bit // 8] ^= 1 << bit % 8
        assert Receiver(message.protection).take(bytes(flipped)) == WRONG_CRC


def test_the_id_is_part_of_the_crc() -> None:
    data = frame("CurrentDemand", 3)
    assert receiver("CurrentMeasured").take(data) == WRONG_CRC


def test_counters_run_modulo_16() -> None:
    status = receiver("Status")
    assert [status.take(frame("Status", n % 16)) for n in range(7, 45)] == [OK] * 38
    assert (status.lost, status.repeated) == (0, 0)


@pytest.mark.parametrize("missing", range(1, 15))
def test_missing_frames_are_counted(missing: int) -> None:
    status = receiver("Status")
    status.take(frame("Status", 9))
    assert status.take(frame("Status", (10 + missing) % 16)) == JUMPED
    assert status.lost == missing


def test_a_repeated_frame_is_not_trusted() -> None:
    status = receiver("Status")
    assert status.take(frame("Status", 4)) == OK
    assert status.take(frame("Status", 4)) == REPEATED
    assert status.take(frame("Status", 5)) == OK
    assert (status.lost, status.repeated) == (0, 1)


def test_after_a_gap_any_counter_is_right() -> None:
    status = receiver("Status")
    status.take(frame("Status", 4))
    status.forget()
    assert status.take(frame("Status", 12)) == OK and status.lost == 0


@pytest.mark.parametrize("length", [0, 1, 7, 9])
def test_another_length_is_no_status(length: int) -> None:
    status = receiver("Status")
    assert status.take(bytes(length)) == WRONG_SHAPE and status.wrong_shape == 1


def test_counters_that_senders_choose_are_not_judged() -> None:
    request = receiver("ServiceRequest")
    assert [request.take(frame("ServiceRequest", n)) for n in (3, 3, 11)] == [OK] * 3
    assert request.lost == 0
