"""Answers that come late: a computer under load, or a controller on one."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import can
import pytest
from quiesce.can.buses import Bus
from quiesce.can.database import Database, load
from quiesce.can.e2e import ALIVE_PERIOD, alive_of, protect
from quiesce.can.link import Link
from quiesce.can.services import REPLY_S, SILENT_S, Reply, Requests, Services


@contextmanager
def controller(name: str, database: Database, late_s: float, deaf: int = 0) -> Iterator[None]:
    """Answers every request, each so late; the first ones not at all. Identifies itself."""
    is_over = threading.Event()
    with can.Bus(interface="virtual", channel=name) as bus:

        def serve() -> None:
            due: list[tuple[float, can.Message]] = []
            seen = 0
            while not is_over.is_set():
                message = bus.recv(0.005)
                if message is not None:
                    seen += 1
                    if seen > deaf:
                        due.append((time.monotonic() + late_s, answer(database, message)))
                while due and due[0][0] <= time.monotonic():
                    bus.send(due.pop(0)[1])

        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield
        finally:
            is_over.set()
            thread.join()


def answer(database: Database, request: can.Message, index: int | None = None) -> can.Message:
    """About the index asked for, or that one. The value is that of the index, plus 1000."""
    asked = database.raw(request.arbitration_id, bytes(request.data))
    index = asked["param_index"] if index is None else index
    layout = database.by_name["ServiceReply"].protection
    before = database.by_name["ServiceRequest"].protection
    assert layout is not None and before is not None
    data = database.encode(
        "ServiceReply",
        operation=asked["operation"],
        param_index=index,
        result=database.number("ServiceReply", "result", "DONE"),
        param_value=1000 + index,
    )
    return can.Message(
        arbitration_id=database.by_name["ServiceReply"].frame_id,
        is_extended_id=False,
        data=protect(layout, alive_of(before, bytes(request.data)), data),
    )


@contextmanager
def asking(name: str, **how: Any) -> Iterator[Services]:
    database = load()
    with controller(name, database, **how), Link(Bus("virtual", name, None, ())) as link:
        services = Services(link, database)
        services._is_understood = True
        yield services


def test_an_answer_that_is_later_than_each_try_is_one() -> None:
    with asking("late", late_s=2.5 * REPLY_S) as services:
        for index in (3, 4, 5):  # answers to what was asked before come in between
            assert services.ask("READ", index) == Reply("DONE", index, 1000 + index)


def test_a_late_answer_about_another_index_is_none() -> None:
    """Counters of 4 bits come round: after 16 requests one is as old as the first again."""
    database = load()
    requests = Requests(database)
    first = answer(database, request_of(requests, "READ", 3))
    for _ in range(ALIVE_PERIOD):
        last = request_of(requests, "READ", 4)
    assert requests.reply_in(first, tries=ALIVE_PERIOD - 1) is None
    assert requests.reply_in(answer(database, last)) == Reply("DONE", 4, 1004)


def test_apply_answers_about_the_parameter_that_is_at_fault() -> None:
    database = load()
    requests = Requests(database)
    reply = answer(database, request_of(requests, "APPLY", 0), index=9)
    assert requests.reply_in(reply) == Reply("DONE", 9, 1009)


def request_of(requests: Requests, operation: str, index: int) -> can.Message:
    return can.Message(
        arbitration_id=requests.request_id,
        is_extended_id=False,
        data=requests.make(operation, index),
    )


def test_a_bus_that_is_silent_for_a_while_is_asked_on() -> None:
    tries = 3
    with asking("silent", late_s=0.0, deaf=2 * tries) as services:
        assert services.ask("READ", 7, tries=tries) == Reply("DONE", 7, 1007)


def test_nobody_is_given_up() -> None:
    start_s = time.monotonic()
    with asking("nobody", late_s=0.0, deaf=1000) as services:
        assert services.ask("READ", 7) is None
    assert time.monotonic() - start_s > SILENT_S


def test_what_came_while_this_computer_was_busy_is_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with asking("busy", late_s=0.0) as services:
        send = services.link.send

        def slow(frame_id: int, data: bytes) -> Any:
            message = send(frame_id, data)
            time.sleep(2.0 * REPLY_S)
            return message

        monkeypatch.setattr(services.link, "send", slow)
        reply = services.ask_once("READ", 9)
    assert reply == Reply("DONE", 9, 1009)
