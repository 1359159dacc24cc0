"""Reading all parameters on a bus that loses frames, or is slow."""

from types import SimpleNamespace

import pytest
from quiesce.can.database import load
from quiesce.can.e2e import alive_of, protect
from quiesce.can.parameters import hash_of
from quiesce.can.recorder import Preamble, RawStream
from quiesce.can.services import DONE, NO_SUCH_PARAMETER, REPLY, REPLY_S, TRIES, ReadAll, Requests

DATABASE = load()
REQUEST = DATABASE.by_name["ServiceRequest"]
VALUES = [70, 80, 90, 100]


def answer(request: bytes, values: list[int] = VALUES) -> SimpleNamespace:
    """A controller's reply to a READ."""
    asked = DATABASE.raw(REQUEST.frame_id, request)
    index = asked["param_index"]
    is_there = index < len(values)
    data = DATABASE.encode(
        REPLY,
        operation=asked["operation"],
        result=DATABASE.number(REPLY, "result", DONE if is_there else NO_SUCH_PARAMETER),
        param_index=index,
        param_value=values[index] if is_there else 0,
    )
    message = DATABASE.by_name[REPLY]
    alive = alive_of(REQUEST.protection, request)
    return frame_of(message.frame_id, protect(message.protection, alive, data))


def frame_of(frame_id: int, data: bytes) -> SimpleNamespace:
    return SimpleNamespace(arbitration_id=frame_id, data=data, timestamp=0.0)


def operation_of(request: bytes) -> str:
    return DATABASE.label(
        REQUEST.name, "operation", DATABASE.raw(REQUEST.frame_id, request)["operation"]
    )


def index_of(request: bytes) -> int:
    return DATABASE.raw(REQUEST.frame_id, request)["param_index"]


def silence(reader: ReadAll, now_s: float) -> tuple[list[bytes], float]:
    """Every request until it gives up, none answered; and when that was."""
    asked = []
    while not reader.is_over:
        request = reader.poll(now_s)
        asked += [request] if request else []
        now_s += REPLY_S
    return asked, now_s


@pytest.mark.parametrize("late", range(TRIES))
def test_a_late_reply_counts(late: int) -> None:
    """Every answer comes after so many more requests."""
    reader, now_s = ReadAll(Requests(DATABASE)), 0.0
    while not reader.is_over:
        first = reader.poll(now_s)
        for _ in range(late):
            now_s += REPLY_S
            reader.poll(now_s)
        assert reader.take(answer(first))
        now_s += REPLY_S
    assert reader.is_complete and reader.values == VALUES


def test_a_reply_counts_once_and_for_its_own_index() -> None:
    reader = ReadAll(Requests(DATABASE))
    first = reader.poll(0.0)
    second = reader.poll(REPLY_S)
    assert reader.take(answer(second)) and not reader.take(answer(first))
    assert not reader.take(answer(second))
    third = reader.poll(2 * REPLY_S)
    assert index_of(third) == 1 and not reader.take(answer(second))
    assert reader.values == VALUES[:1]


def test_it_goes_on_where_it_gave_up() -> None:
    reader, now_s = ReadAll(Requests(DATABASE)), 0.0
    for index in range(2):
        request = reader.poll(now_s)
        assert index_of(request) == index and reader.take(answer(request))
        now_s += REPLY_S
    asked, now_s = silence(reader, now_s)
    assert [index_of(one) for one in asked] == [2] * TRIES
    assert reader.is_given_up and reader.poll(now_s) is None
    reader.go_on()
    asked = []
    while not reader.is_over:
        asked.append(reader.poll(now_s))
        reader.take(answer(asked[-1]))
        now_s += REPLY_S
    assert [index_of(one) for one in asked] == [2, 3, 4]  # 4: there is none
    assert reader.is_complete and reader.values == VALUES


class Bus:
    """Keeps the requests; time is the test's."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_s = 1000.0
        clock = SimpleNamespace(monotonic=lambda: self.now_s, monotonic_ns=lambda: 0)
        for module in ("recorder", "services"):
            monkeypatch.setattr(f"quiesce.can.{module}.time", clock)
        self.asked: list[bytes] = []

    def send(self, _: int, data: bytes) -> bytes:
        self.asked.append(data)
        return data


def request_of(preamble: Preamble, bus: Bus) -> bytes | None:
    """What it asks now."""
    before = len(bus.asked)
    preamble.poll()
    return bus.asked[before] if len(bus.asked) > before else None


@pytest.fixture
def bus(monkeypatch: pytest.MonkeyPatch) -> Bus:
    return Bus(monkeypatch)


def identification(values: list[int]) -> SimpleNamespace:
    message = DATABASE.by_name["Identification"]
    said = {name: 0 for name in ("version_major", "version_minor", "version_patch")}
    data = DATABASE.encode(
        message.name, **said, interface_version=DATABASE.version, param_hash=hash_of(values)
    )
    return frame_of(message.frame_id, data)


def test_the_next_identification_makes_it_go_on(bus: Bus) -> None:
    preamble = Preamble(bus, DATABASE)
    preamble.take(identification(VALUES))
    preamble.take(answer(request_of(preamble, bus)))
    while not preamble.is_over:
        bus.now_s += REPLY_S
        preamble.poll()
    bus.asked.clear()
    bus.now_s += 10.0
    preamble.take(identification(VALUES))
    while not preamble.is_over:
        bus.now_s += REPLY_S
        preamble.take(answer(request_of(preamble, bus)))
    assert [index_of(one) for one in bus.asked] == [1, 2, 3, 4]
    assert preamble.values == VALUES and preamble.is_complete


def test_parameters_that_changed_meanwhile_are_read_from_the_start(bus: Bus) -> None:
    others = [1, *VALUES[1:]]
    preamble = Preamble(bus, DATABASE)
    preamble.take(identification(VALUES))
    preamble.take(answer(request_of(preamble, bus)))
    for _ in range(2):  # the first time with one value of before
        bus.now_s += 10.0
        preamble.take(identification(others))
        while not preamble.is_over:
            bus.now_s += REPLY_S
            preamble.take(answer(request_of(preamble, bus), others))
    assert preamble.values == others


def test_samples_are_asked_for_while_no_parameter_is_answered(bus: Bus) -> None:
    """A bus on which reading them takes minutes must not be without samples for as long."""
    preamble = Preamble(bus, DATABASE)
    raw = RawStream(bus, DATABASE, preamble)
    assert raw.poll() is None  # nothing before the controller has told that it understands
    preamble.take(identification(VALUES))
    preamble.poll()
    assert raw.poll() is None  # one at a time
    bus.now_s += REPLY_S
    assert operation_of(raw.poll()) == "RAW_STREAM" and request_of(preamble, bus) is None
    bus.now_s += 0.02
    assert operation_of(request_of(preamble, bus)) == "READ" and raw.poll() is None
