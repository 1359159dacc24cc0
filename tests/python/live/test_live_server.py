"""`quiesce live` through real websockets, beside a real controller on UDP multicast or a pty."""

import contextlib
import json
import time
from collections.abc import Iterator
from pathlib import Path

import can
import numpy as np
import pytest
from can_bus import Controller, build_peer
from live_page import Packet, Page, Viewer, pull
from quiesce.can.database import load
from quiesce.can.parameters import parameters
from quiesce.live.protocol import MAX_MESSAGE_BYTES, MOST_MALFORMED
from quiesce.live.room import MOST_VIEWERS
from quiesce_benchmarks.live.rig import PATIENCE_S, Network
from websockets.exceptions import ConnectionClosed

DATABASE = load()
DEMAND = DATABASE.by_name["CurrentDemand"]


@pytest.fixture(scope="session")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("live_peer"))


@pytest.fixture
def controller(peer: Path, tmp_path: Path) -> Iterator[Controller]:
    one = Controller(peer, tmp_path)
    yield one
    one.stop()


@pytest.fixture
def network(controller: Controller) -> Iterator[Network]:
    """The controller, armed, on UDP multicast."""
    controller.start()
    one = Network(controller.path)
    yield one
    one.end()


@pytest.fixture
def serve(tmp_path: Path) -> Iterator:
    """Starts a page; it must end well."""
    pages = []

    def start(*options: str) -> Page:
        pages.append(Page(tmp_path, *options))
        return pages[-1]

    yield start
    assert [one.end() for one in pages] == [0] * len(pages)


@pytest.fixture
def page(serve, controller: Controller) -> Page:
    """On the line of a controller that is armed."""
    controller.start()
    return serve("--bus", controller.bus)


@pytest.fixture(scope="module")
def shared(peer: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """A page for those who leave its controller as it was, and armed."""
    folder = tmp_path_factory.mktemp("shared")
    controller = Controller(peer, folder)
    controller.start()
    one = Page(folder, "--bus", controller.bus)
    yield one
    assert one.end() == 0
    controller.stop()


def ready(viewer: Viewer) -> list[int]:
    """Waits until the parameters are read; their values."""
    return viewer.until("parameters", lambda one: one["values"])["values"]


def value_of(told: dict, name: str) -> int:
    index = next(one["index"] for one in parameters() if one["name"] == name)
    return told["values"][index]


# Samples


def watched(page: Page) -> tuple[list[Packet], int]:
    """Packets of the eight signals at 1 kHz, and the series that counts the controller's ticks."""
    with page.viewer() as viewer:
        viewer.until("state", lambda state: state["controller"]["raw_is_streaming"])
        assert len(viewer.every_ms()) == 8
        viewer.ask("show", series=viewer.every_ms())
        return viewer.watch(75), viewer.series("RawSample", "tick_low")


def check_numbers(packets: list[Packet]) -> None:
    """None is missing that the server has had."""
    assert np.all(np.diff([one.number for one in packets]) == 1)
    for frame_id in (DEMAND.frame_id, DATABASE.by_name["RawSample"].frame_id):
        blocks = [one for packet in packets for one in packet.blocks if one.frame_id == frame_id]
        ends = [one.first + len(one.times_s) for one in blocks]
        assert [one.first for one in blocks][1:] == ends[:-1] and len(blocks) > 10
        assert all(len(v) == len(one.times_s) for one in blocks for v in one.columns.values())


def ticks_of(packets: list[Packet], tick: int) -> np.ndarray:
    blocks = (one for packet in packets for one in packet.blocks)
    return np.concatenate([one.columns[tick] for one in blocks if tick in one.columns])


def test_every_sample_of_eight_signals_comes_once(serve, controller: Controller) -> None:
    """At 1 kHz over a line that waits for its reader; the controller's ticks tell what is lost."""
    controller.start()
    packets, tick = watched(serve("--bus", controller.bus, "--raw"))
    check_numbers(packets)
    ticks = ticks_of(packets, tick)
    assert len(ticks) > 500 and np.all(np.diff(ticks) % 65536 == 1)


def test_samples_come_in_order_over_udp(serve, network: Network) -> None:
    """Where the machine is busy UDP loses frames before anybody has had them."""
    packets, tick = watched(serve(*network.options, "--raw"))
    check_numbers(packets)
    steps = np.diff(ticks_of(packets, tick)) % 65536
    assert len(steps) > 100 and np.all((steps >= 1) & (steps < 32768))


@pytest.mark.slow
def test_samples_are_the_controllers_numbers(shared: Page) -> None:
    with shared.viewer() as viewer:
        values = dict(zip((p["name"] for p in parameters()), ready(viewer), strict=True))
        current = viewer.series("CurrentDemand", "current_cmd_mA")
        viewer.ask("show", series=[current])
        viewer.until("state", lambda state: state["controller"]["state"] == "RUN")
        packets = viewer.watch(10)
    commanded = {float(v) for p in packets for b in p.blocks for v in b.columns.get(current, ())}
    assert commanded and max(commanded) <= values["max_current_mA"]
    ages_s = [packet.sent_s - packet.newest_s for packet in packets]
    assert all(0.0 <= age < PATIENCE_S for age in ages_s)


@pytest.mark.slow
def test_viewer_that_comes_gets_the_history(shared: Page) -> None:
    with shared.viewer() as first:
        first.watch(50)
        with shared.viewer() as second:
            (packet,) = second.watch(1)
    (block,) = (one for one in packet.blocks if one.frame_id == DEMAND.frame_id)
    assert packet.sent_s - block.times_s[0] > 1.5  # of the 2 s that the first has been there
    assert np.all(np.diff(block.times_s) >= 0.0)


# Commands


def test_parameters_are_changed_stored_and_reverted(page: Page) -> None:
    with page.viewer() as viewer:
        told = viewer.until("parameters", lambda one: one["values"])
        before = told["values"]
        assert told["before"] == {"values": before, "is_saved": False}
        viewer.ask("take")
        viewer.until("state", lambda state: state["holder"] == viewer.hello["viewer"])
        viewer.ask("set", settings={"unlock_current_mA": "3000"})
        changed = viewer.until("parameters", lambda one: one["values"] != before)
        assert value_of(changed, "unlock_current_mA") == 3000
        assert viewer.note() == {"is_ok": True, "text": "1 changed and read back", "of": "set"}
        viewer.ask("revert")
        assert viewer.until("parameters", lambda one: one["values"] == before)
        assert viewer.note()["is_ok"]
        viewer.ask("set", settings={"unlock_current_mA": "3100"})
        assert viewer.note()["is_ok"]
        viewer.ask("save")
        told = viewer.until("parameters", lambda one: one["before"]["is_saved"])
        assert value_of(told["before"], "unlock_current_mA") == 3100
        assert viewer.note() == {"is_ok": True, "text": "stored for the next start", "of": "save"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"unlock_current_mA": "much"}, "an integer in 0 .. 20000 mA"),
        ({"colour": "1"}, "no parameter 'colour'"),
        ({"law": "constant"}, "the controller is armed, and law may not change then"),
    ],
)
def test_a_change_that_is_not_allowed_changes_nothing(shared: Page, settings, words: str) -> None:
    with shared.viewer() as viewer:
        before = ready(viewer)
        viewer.ask("take")
        viewer.ask("set", settings=settings)
        note = viewer.note()
        assert not note["is_ok"] and words in note["text"]
    with shared.viewer() as viewer:
        assert ready(viewer) == before


@pytest.mark.slow
def test_one_holds_control_until_he_is_gone(shared: Page) -> None:
    with shared.viewer() as second:
        ready(second)
        with shared.viewer() as first:
            first.ask("take")
            first.until("state", lambda state: state["holder"] == first.hello["viewer"])
            second.ask("take")
            assert second.note()["text"] == f"viewer {first.hello['viewer']} holds control"
            for do in ({"do": "save"}, {"do": "revert"}, {"do": "set", "settings": {"law": "off"}}):
                second.socket.send(json.dumps(do))
                assert second.note() == {
                    "is_ok": False,
                    "text": "take control first",
                    "of": do["do"],
                }
        second.until("state", lambda state: state["holder"] is None)
        second.ask("take")
        second.until("state", lambda state: state["holder"] == second.hello["viewer"])
        second.ask("release")
        second.until("state", lambda state: state["holder"] is None)


# STOP


def is_safe(frame: can.Message) -> bool:
    """Whether it demands that the driver is off."""
    if frame.arbitration_id != DEMAND.frame_id:
        return False
    raw = DATABASE.raw(DEMAND.frame_id, bytes(frame.data))
    return raw["driver_is_enabled"] == 0 and raw["current_cmd_mA"] == 0


def wait_safe(bus: can.BusABC) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        frame = bus.recv(1.0)
        if frame is not None and is_safe(frame):
            return
    raise AssertionError("no safe demand on the bus")


def test_stop_reaches_the_bus_without_control(serve, network: Network) -> None:
    with network.listen() as bus, serve(*network.options).viewer() as viewer:
        viewer.until("state", lambda state: state["controller"]["state"] == "RUN")
        viewer.ask("stop")
        wait_safe(bus)
        told = viewer.until("state", lambda state: state["stop"]["state"] == "confirmed")
        assert told["stop"]["is_sent"]
        state = viewer.until("state", lambda state: state["first_fault"] is not None)
    assert state["controller"]["fault"] == "ESTOP" and state["faults"] == {"ESTOP": 1}
    assert state["first_fault"]["fault"] == "ESTOP"
    assert state["first_fault"]["state_before"] == "RUN"


@pytest.mark.slow
def test_stop_by_http_while_the_websocket_is_away(page: Page) -> None:
    assert page.post("/stop") == 200
    with page.viewer() as viewer:
        viewer.until("state", lambda state: state["stop"]["state"] == "confirmed")


@pytest.mark.slow
def test_stop_is_never_given_up(serve, controller: Controller) -> None:
    """The controller is away when it is pressed; the next one is stopped when it comes."""
    controller.start("--silent")
    page = serve("--bus", controller.bus)
    with page.viewer() as viewer:
        viewer.ask("stop")
        told = viewer.until("state", lambda state: state["stop"]["waited_s"] > 0.5)
        assert told["stop"] == {**told["stop"], "state": "pressed", "is_sent": True}
        pull(controller)
        viewer.until("state", lambda state: not state["bus"]["is_up"])
        controller.start()
        viewer.until("state", lambda state: state["stop"]["state"] == "confirmed")


# The bus goes away


@pytest.mark.slow
def test_loss_and_return_of_the_bus_are_survived_and_shown(serve, controller: Controller) -> None:
    controller.start()
    with serve("--bus", controller.bus).viewer() as viewer:
        ready(viewer)
        for losses in (1, 2):
            pull(controller)
            lost = viewer.until("state", lambda state: not state["bus"]["is_up"])
            assert lost["bus"]["losses"] == losses and lost["bus"]["lost"]
            old = viewer.until("state", lambda state: state["bus"]["age_s"] > 0.3)
            assert old["bus"]["status_age_s"] >= old["bus"]["age_s"]
            controller.start()
            viewer.until("state", lambda s: s["bus"]["is_up"] and s["bus"]["age_s"] < 0.3)
            assert len(viewer.watch(5)) >= 5


@pytest.mark.slow
def test_another_controllers_messages_are_asked_nothing(serve, controller: Controller) -> None:
    controller.start("--interface", "4")
    with serve("--bus", controller.bus).viewer() as viewer:
        state = viewer.until("state", lambda state: state["controller"]["misunderstood"])
        assert "these tools have" in state["controller"]["misunderstood"]
        viewer.ask("take")
        viewer.ask("set", settings={"law": "off"})
        assert "these tools have" in viewer.note()["text"]


@pytest.mark.slow
def test_malformed_frames_of_the_bus_are_counted(serve, controller: Controller) -> None:
    controller.start("--corrupt", "7")
    with serve("--bus", controller.bus).viewer() as viewer:
        state = viewer.until("state", lambda state: state["bus"]["wrong_crc"] > 50)
        assert state["bus"]["is_up"]


# Hostile viewers


MALFORMED = (
    "", "no JSON", "[]", "3", "null", '{"do": 1}', '{"do": "fly"}', '{"do": ["stop"]}',
    '{"do": "stop", "now": true}', '{"do": "show"}', '{"do": "show", "series": [99999]}',
    '{"do": "show", "series": [true]}', '{"do": "show", "series": [0,1,2,3,4,5,6,7,8]}',
    '{"do": "set", "settings": {}}', '{"do": "set", "settings": {"law": 1}}',
    '{"do": "set", "settings": []}', b"\x01\x02", "[" * 4000,
)  # fmt: skip


def test_malformed_messages_are_told_and_cost_nothing(shared: Page) -> None:
    assert len(MALFORMED) < MOST_MALFORMED
    with shared.viewer() as other, shared.viewer() as viewer:
        ready(other)
        for message in MALFORMED:
            viewer.socket.send(message)
            note = viewer.note()
            assert not note["is_ok"] and note["text"].startswith("not understood: "), message
        viewer.ask("take")
        viewer.until("state", lambda state: state["holder"] == viewer.hello["viewer"])
        assert other.until("state", lambda state: True)["stop"]["state"] == "idle"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("messages", "code"),
    [
        (["x" * (MAX_MESSAGE_BYTES + 1)], 1009),
        (["nonsense"] * MOST_MALFORMED, 1008),
        ([b"\xff\xfe" * MAX_MESSAGE_BYTES], 1009),
    ],
)
def test_who_sends_too_much_is_sent_away_and_others_stay(shared: Page, messages, code: int) -> None:
    with shared.viewer() as other, contextlib.ExitStack() as stack:
        viewer = stack.enter_context(shared.viewer())
        with pytest.raises(ConnectionClosed) as closed:
            for message in messages:
                viewer.socket.send(message)
            while True:
                viewer.socket.recv(PATIENCE_S)
        assert closed.value.rcvd.code == code
        other.until("state", lambda state: state["viewers"] == 1)
        assert other.watch(5)


@pytest.mark.slow
def test_there_are_enough_viewers(page: Page) -> None:
    with contextlib.ExitStack() as stack:
        viewers = [stack.enter_context(page.viewer()) for _ in range(MOST_VIEWERS)]
        assert len({one.hello["viewer"] for one in viewers}) == MOST_VIEWERS
        with pytest.raises(Exception, match="rejected|1013"), page.socket() as socket:
            socket.recv(PATIENCE_S)
        viewers[0].ask("stop")
        for one in viewers:
            one.until("state", lambda state: state["stop"]["state"] == "confirmed")
