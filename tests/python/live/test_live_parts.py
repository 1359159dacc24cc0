"""Parts of the live page's server, each by itself."""

import json
import math
import os
import threading
import time
import tty
from collections import deque
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from live_page import packet_of
from quiesce.base.errors import UsageError
from quiesce.can.buses import Bus
from quiesce.can.database import load
from quiesce.can.e2e import protect
from quiesce.can.link import Back, Link, Lost
from quiesce.can.parameters import parameters
from quiesce.live.control import Control
from quiesce.live.desk import Desk
from quiesce.live.freeze import FirstFault
from quiesce.live.jobs import wanted
from quiesce.live.protocol import (
    MOST_SERIES,
    Block,
    Command,
    Malformed,
    command_of,
    pack_samples,
)
from quiesce.live.rings import Ring
from quiesce.live.series import catalogue, preferred

DATABASE = load()
SERIES = catalogue(DATABASE)


# Series


def test_every_series_decodes_as_the_database_does() -> None:
    random = np.random.default_rng(5)
    for one in SERIES:
        length = DATABASE.by_id[one.frame_id].length
        frames = [bytes(length), b"\xff" * length]
        frames += [random.bytes(length) for _ in range(50)]
        words = np.array([int.from_bytes(data, "little") for data in frames], np.uint64)
        raw = [DATABASE.raw(one.frame_id, data) for data in frames]
        wanted = np.array([said[one.signal] for said in raw], np.float32)
        if (one.message, one.signal) == ("RawSample", "current_meas_mA"):
            wanted[[said["current_is_measured"] == 0 for said in raw]] = np.nan
        assert np.array_equal(one.values(words), wanted, equal_nan=True), one


def test_catalogue_has_what_is_sent_and_nothing_that_protects_or_asks() -> None:
    names = {(one.message, one.signal) for one in SERIES}
    assert ("CurrentMeasured3", "current_meas_mA") in names
    assert ("RawSample", "tick_low") in names
    assert not {signal for _, signal in names} & {"alive", "crc"}
    assert not {message for message, _ in names} & {"ServiceReply", "FaultFreeze", "EmergencyStop"}
    assert [one.number for one in SERIES] == list(range(len(SERIES)))


def test_preferred_are_the_first_of_each_row_that_are_heard() -> None:
    ids = {name: DATABASE.by_name[name].frame_id for name in ("RawSample", "AccelSample", "Status")}

    def names(*heard: str) -> list[str]:
        numbers = preferred(SERIES, {ids[one] for one in heard})
        return [f"{SERIES[one].message}.{SERIES[one].signal}" for one in numbers]

    assert names() == []
    assert names("AccelSample", "Status") == ["AccelSample.accel_counts", "Status.rms_um_s2"]
    assert names("RawSample", "AccelSample")[0] == "RawSample.accel_counts"
    everything = {one.frame_id for one in SERIES}
    assert len(preferred(SERIES, everything)) <= MOST_SERIES


# Rings


def test_ring_keeps_the_last_and_numbers_all() -> None:
    ring = Ring(4)
    for i in range(6):
        ring.add(float(i), bytes([i]))
    first, times_s, words = ring.read(0, 100)
    assert (first, list(times_s), list(words)) == (2, [2.0, 3.0, 4.0, 5.0], [2, 3, 4, 5])
    assert ring.read(5, 100)[2].tolist() == [5]
    assert ring.read(6, 100)[2].tolist() == [] and ring.read(3, 2)[2].tolist() == [3, 4]
    assert ring.first_kept(3.5) == 4 and ring.first_kept(99.0) == 6


def test_ring_keeps_the_order_where_a_clock_is_set_back() -> None:
    ring = Ring(4)
    for time_s in (5.0, 1.0, 6.0):
        ring.add(time_s, b"\x01")
    assert ring.read(0, 9)[1].tolist() == [5.0, 5.0, 6.0]


# Protocol


def test_packet_goes_there_and_back() -> None:
    times_s = 1.8e9 + np.array([0.0, 0.001, 0.0025])
    columns = [(7, np.array([1.0, -2.0, 3.0], np.float32)), (9, np.zeros(3, np.float32))]
    blocks = [Block(16, 2**32 + 5, times_s, columns), Block(384, 0, times_s[:1], [])]
    packet = packet_of(pack_samples(2**32 + 1, 1.8e9, math.nan, blocks))
    assert (packet.number, packet.sent_s) == (1, 1.8e9) and math.isnan(packet.newest_s)
    first, second = packet.blocks
    assert (first.frame_id, first.first) == (16, 5)
    assert np.allclose(first.times_s, times_s, atol=1e-6, rtol=0.0)
    assert {number: list(values) for number, values in first.columns.items()} == {
        7: [1.0, -2.0, 3.0],
        9: [0.0, 0.0, 0.0],
    }
    assert (second.first, len(second.times_s), second.columns) == (0, 1, {})


def test_commands_are_what_the_reference_says() -> None:
    def said(**words) -> Command:
        return command_of(json.dumps(words), len(SERIES))

    assert said(do="stop") == Command("stop")
    assert said(do="show", series=[3, 1, 3]) == Command("show", series=(3, 1))
    assert said(do="set", settings={"law": "off"}) == Command("set", settings=("law=off",))


@pytest.mark.parametrize("nested", ["[" * 100_000, '{"do":' * 50_000])
def test_deep_nesting_is_malformed(nested: str) -> None:
    with pytest.raises(Malformed):
        command_of(nested, len(SERIES))


# Control


def test_control_is_held_by_one_and_free_when_he_goes() -> None:
    control = Control()
    assert control.take(1) and control.take(1) and not control.take(2)
    control.release(2)
    assert control.holder == 1
    control.release(1)
    assert control.take(2) and control.holder == 2


# The first fault


def pages(number: int, fault: str) -> list[bytes]:
    label = DATABASE.number("FaultFreeze", "freeze_fault", fault)
    codec = DATABASE.codec.get_message_by_name("FaultFreeze")
    said = {"freeze_number": number, "freeze_fault": label, "freeze_current_cmd_mA": 1500}
    return [
        bytes(
            codec.encode(
                {**{name: 0 for name in names(codec, page)}, **said, "page": page}, strict=False
            )
        )  # noqa: E501
        for page in range(6)
    ]


def names(codec, page: int) -> list[str]:
    return [s.name for s in codec.signals if s.multiplexer_ids in (None, [page])]


def test_first_fault_stays_until_the_next_after_health() -> None:
    frame_id = DATABASE.by_name["FaultFreeze"].frame_id
    first = FirstFault(DATABASE)

    def freeze(number: int, fault: str) -> None:
        for page in pages(number, fault):
            first.take(frame_id, page)

    first.take(frame_id, pages(1, "SENSOR_LOST")[0])
    assert first.frame is None  # pages are missing
    for _ in range(3):  # repeated each second
        freeze(1, "SENSOR_LOST")
    assert (first.frame["fault"], first.later) == ("SENSOR_LOST", 0)
    assert ["commanded current", 1.5, "A"] in first.frame["values"]
    assert "frequency" not in [title for title, _, _ in first.frame["values"]]  # it was not valid
    freeze(2, "ESTOP")
    assert (first.frame["fault"], first.later) == ("SENSOR_LOST", 1)
    first.healthy()
    freeze(3, "COIL_OPEN")
    assert (first.frame["fault"], first.later) == ("COIL_OPEN", 0)
    first.take(frame_id, b"\xff" * 8)  # of no page that there is
    assert first.frame["fault"] == "COIL_OPEN"


# Changes


def test_wanted_is_what_differs_or_is_not_there() -> None:
    values = [one["default"] for one in parameters()]
    law = next(one for one in parameters() if one["name"] == "law")
    assert wanted((f"law={law['labels'][law['default']]}",), values) == {}
    assert wanted(("law=off",), values) == {law["index"]: 0}
    assert wanted(("law=off",), values[: law["index"]]) == {law["index"]: 0}  # older firmware
    with pytest.raises(UsageError, match="law is one of"):
        wanted(("law=fast",), values)


# The desk


class SilentLink:
    """A bus on which nothing comes but what a test puts there; what is sent is kept."""

    def __init__(self) -> None:
        self.bus = SimpleNamespace(name="silent:0")
        self.is_up, self.malformed = True, 0
        self.sent: list[tuple[int, bytes]] = []
        self.events: deque[object] = deque()

    def mark(self, event: object) -> None:
        self.events.append(event)

    def send(self, frame_id: int, data: bytes) -> object:
        self.sent.append((frame_id, data))
        return SimpleNamespace(arbitration_id=frame_id, data=data, timestamp=time.time())

    def receive_now(self) -> object:
        return self.events.popleft() if self.events else None


def test_desk_of_a_silent_bus_tells_that_nothing_came() -> None:
    desk = Desk(SilentLink(), DATABASE)
    desk.drain()
    told = json.loads(json.dumps(desk.told(), allow_nan=False))
    assert told["bus"]["age_s"] is None and told["controller"]["state"] == ""
    assert told["heard"] == [] and told["preferred"] == []
    assert desk.fault_names()[0] == "PARAMETER" and "NONE" not in desk.fault_names()


def test_desk_takes_any_frame_and_trusts_none_that_is_wrong() -> None:
    desk = Desk(SilentLink(), DATABASE)
    random = np.random.default_rng(7)
    for i in range(20_000):
        known = int(random.choice(list(DATABASE.by_id)))
        frame = SimpleNamespace(
            arbitration_id=known if i % 3 else int(random.integers(0, 0x800)),
            data=random.bytes(int(random.integers(0, 9))),
            timestamp=1000.0 + i * 1e-3,
            is_error_frame=i % 50 == 0,
            is_extended_id=i % 60 == 0,
            is_remote_frame=i % 70 == 0,
        )
        desk.take(frame)
    desk.take(Lost(1020.0, "gone"))
    desk.take(Back(1021.0, 1.0))
    json.dumps(desk.told(), allow_nan=False)
    assert desk.traffic.total("wrong_crc") > 300 and desk.traffic.frames == 20_000


def test_stop_is_repeated_until_it_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = SimpleNamespace(now_s=1000.0)
    monkeypatch.setattr("quiesce.live.stop.time", SimpleNamespace(monotonic=lambda: clock.now_s))
    link = SilentLink()
    desk = Desk(link, DATABASE)
    stop = desk.stop
    stop.poll()
    assert link.sent == [] and stop.state == "idle"
    stop.reported("ESTOP")  # by somebody else's button
    assert stop.state == "idle"
    for _ in range(1000):
        stop.press()
    assert [frame_id for frame_id, _ in link.sent] == [0x20]
    clock.now_s += 0.049
    stop.poll()
    assert len(link.sent) == 1
    clock.now_s += 0.002
    stop.poll()
    stop.poll()
    assert [frame_id for frame_id, _ in link.sent] == [0x20, 0x20]
    assert link.sent[0] != link.sent[1]  # another alive counter
    stop.reported("SENSOR_LOST")
    assert stop.told()["state"] == "pressed"
    clock.now_s += 0.949
    stop.press()  # once more: it has still been in vain for a second
    assert len(link.sent) == 3
    assert stop.told() == {"state": "pressed", "is_sent": True, "waited_s": 1.0}
    desk.drain()
    stop.reported("ESTOP")
    assert stop.told() == {"state": "confirmed", "is_sent": True, "waited_s": 0.0}
    stop.reported("NONE")
    assert stop.state == "idle"


def test_recordings_have_what_is_sent_where_its_time_is() -> None:
    """Frames come on a line while several threads send, and the desk is late."""
    master, slave = os.openpty()
    tty.setraw(slave)
    with Link(Bus("slcan", os.ttyname(slave), None, ()), echoes=True) as link:
        desk = Desk(link, DATABASE)
        taken: list[Any] = []
        desk.recordings.take = taken.append  # type: ignore[method-assign]

        def sending(number: int) -> None:
            for _ in range(40):
                assert link.send(0x600 + number, b"\1") is not None
                time.sleep(1e-3)

        senders = [threading.Thread(target=sending, args=(number,)) for number in range(3)]
        for one in senders:
            one.start()
        frames = 0
        while any(one.is_alive() for one in senders) or frames < 50:
            os.write(master, b"t1000\r")
            frames += 1
            time.sleep(2e-3)
            if frames % 10 == 0:
                desk.drain()
        end_s = time.monotonic() + 10.0
        while len(taken) < frames + 120 and time.monotonic() < end_s:
            desk.drain()
            time.sleep(0.01)
    os.close(master)
    os.close(slave)
    own = [one for one in taken if not one.is_rx and one.arbitration_id >= 0x600]
    assert len(own) == 120 and sum(one.is_rx for one in taken) == frames
    stamps_s = [one.timestamp for one in taken]
    assert stamps_s == sorted(stamps_s)


STATUS = DATABASE.by_name["Status"]


def status(alive: int, fault: str) -> SimpleNamespace:
    """A frame of the controller's."""
    data = DATABASE.encode("Status", fault=DATABASE.number("Status", "fault", fault))
    return SimpleNamespace(
        arbitration_id=STATUS.frame_id,
        data=protect(STATUS.protection, alive, data),
        timestamp=1000.0 + alive * 0.01,
        is_error_frame=False,
        is_extended_id=False,
        is_remote_frame=False,
    )


def test_only_a_report_that_follows_the_press_confirms_it() -> None:
    """Others wait to be read when it is pressed: of a stop before, which was acknowledged."""
    link = SilentLink()
    desk = Desk(link, DATABASE)
    for press in range(2):
        link.events += [status(3 * press, "ESTOP"), status(3 * press + 1, "ESTOP")]
        desk.stop.press()
        desk.drain()
        assert desk.told()["controller"]["fault"] == "ESTOP"
        assert desk.stop.state == "pressed"
        link.events.append(status(3 * press + 2, "ESTOP"))
        desk.drain()
        assert desk.stop.state == "confirmed"


def test_a_stop_that_the_bus_does_not_take_is_confirmed_by_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    link = SilentLink()
    desk = Desk(link, DATABASE)
    monkeypatch.setattr(link, "send", lambda *_: None)
    desk.stop.press()
    link.events.append(status(0, "ESTOP"))
    desk.drain()
    assert desk.stop.told()["state"] == "pressed" and not desk.stop.told()["is_sent"]
