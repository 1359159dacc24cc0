"""Buses that go away, bytes that are no frames, and logs that are sent again."""

import os
import random
import socket
import threading
import time
import tty
from collections.abc import Iterator, Sequence
from pathlib import Path

import can
import pytest
from conftest import run_quiesce
from quiesce.can.buses import Bus
from quiesce.can.database import load
from quiesce.can.link import Back, Link, Lost, Sent
from quiesce.can.slcan import SlcanBus, frame_of
from quiesce.can.traffic import Seen
from quiesce.can.writers import open_log

WAIT_S = 30.0  # far more than anything takes


@pytest.fixture
def line(tmp_path: Path) -> Iterator[tuple[int, str]]:
    """A pseudo-terminal: our end, and the path of the other one."""
    master, slave = os.openpty()
    tty.setraw(slave)
    yield master, os.ttyname(slave)
    os.close(master)
    os.close(slave)


def received(bus: SlcanBus, count: int) -> list[can.Message]:
    return [bus.recv(WAIT_S) for _ in range(count)]


def test_frames_come_through_in_any_pieces(line) -> None:
    master, path = line
    with SlcanBus(path) as bus:
        for piece in (b"t1", b"002AB", b"CD\rT18FF12", b"341EE\rr12", b"38\r\n\rt7FF0\r"):
            os.write(master, piece)
        frames = received(bus, 4)
    assert [one.arbitration_id for one in frames] == [0x100, 0x18FF1234, 0x123, 0x7FF]
    assert [bytes(one.data) for one in frames] == [b"\xab\xcd", b"\xee", b"", b""]
    assert frames[2].is_remote_frame and frames[2].dlc == 8 and frames[1].is_extended_id


def test_noise_is_dropped_and_frames_between_it_are_not(line) -> None:
    master, path = line
    rng = random.Random(3)
    alphabet = bytes(range(256)) + b"tTrR0123456789ABCDEF" * 20
    with SlcanBus(path) as bus:
        for i in range(300):
            noise = bytes(rng.choice(alphabet) for _ in range(rng.randint(0, 60)))
            # A noise that happens to be a frame would be one.
            noise = b"".join(b"?" + part for part in noise.replace(b"\n", b"\r").split(b"\r"))
            os.write(master, noise + b"\rt100%d" % 2 + b"%04X\r" % i)
            (frame,) = received(bus, 1)
            assert (frame.arbitration_id, bytes(frame.data)) == (0x100, i.to_bytes(2, "big"))


@pytest.mark.parametrize(
    "text",
    [
        b"t", b"t10", b"t100", b"t1009", b"t1002AB", b"t1002ABX", b"tFFF0", b"T2000000001AA",
        b"t1 02ABCD", b"T00000000", b"r1009", b"rFFF0", b"t100\xff", b"t10-2ABCD", b"t1002A\x00CD",
        b"t 104aabbccdd", b"t+104aabbccdd", b"t1_04aabbccdd", b"t0104aabbccddZZ!!@", b"T+18FF12340",
        b"t100 ", b"t1002 A B", b"t10+0", b"t1002ABCD1", b"t1002ABCD12", b"t1002ABCD12345",
        b"t1002ABCDXXXX", b"r10041", b"t1000\x00",
    ],
)  # fmt: skip
def test_malformed_lines_are_no_frames(text: bytes, line) -> None:
    assert frame_of(text, 0.0) is None
    master, path = line
    with SlcanBus(path) as bus:
        os.write(master, text + b"\rt1000\r")
        (frame,) = received(bus, 1)
        assert frame.arbitration_id == 0x100 and bus.malformed == 1


def test_time_stamps_after_frames_are_dropped(line) -> None:
    master, path = line
    with SlcanBus(path) as bus:
        for text in (b"t1002ABcd12aF", b"T18FF12348" + b"11" * 8 + b"FFFF", b"r10081234"):
            os.write(master, text + b"\r")
        frames = received(bus, 3)
        assert bus.malformed == 0
    assert [bytes(one.data) for one in frames] == [b"\xab\xcd", b"\x11" * 8, b""]
    assert [one.dlc for one in frames] == [2, 8, 8]


def test_socketcan_takes_fd_frames_unless_told_not_to() -> None:
    assert Bus("socketcan", "can0", None, ()).driver_options() == {"fd": True}
    assert Bus("socketcan", "can0", None, (("fd", False),)).driver_options() == {"fd": False}
    assert Bus("pcan", "PCAN_USBBUS1", 500_000, ()).driver_options() == {"bitrate": 500_000}


def test_endless_lines_are_counted_once(line) -> None:
    master, path = line
    with SlcanBus(path) as bus:
        os.write(master, b"t" * 3000 + b"\rt1000\r")
        assert received(bus, 1)[0].arbitration_id == 0x100
        assert bus.malformed == 1


class Server:
    """An SLCAN adapter on TCP."""

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.channel = f"socket://127.0.0.1:{self._listener.getsockname()[1]}"

    def accept(self) -> socket.socket:
        connection, _ = self._listener.accept()
        return connection

    def close(self) -> None:
        self._listener.close()


@pytest.fixture
def server() -> Iterator[Server]:
    one = Server()
    yield one
    one.close()


def next_event(link: Link) -> object:
    event = link.receive(WAIT_S)
    assert event is not None
    return event


def test_a_link_tells_loss_and_return_in_order(server: Server) -> None:
    connections: list[socket.socket] = []
    accepting = threading.Thread(target=lambda: connections.append(server.accept()))
    accepting.start()
    with Link(Bus("slcan", server.channel, None, ())) as link:
        accepting.join()
        for number in range(3):
            connections[-1].sendall(b"t10%d0\r" % number)
            event = next_event(link)
            assert isinstance(event, can.Message) and event.arbitration_id == 0x100 + number
            connections.pop().close()
            assert isinstance(next_event(link), Lost)
            connections.append(server.accept())
            event = next_event(link)
            assert isinstance(event, Back) and event.gap_s > 0.0
        assert link.is_up
    connections.pop().close()


def test_sending_on_a_lost_bus_says_so(server: Server) -> None:
    accepting = threading.Thread(target=lambda: server.accept().close())
    accepting.start()
    with Link(Bus("slcan", server.channel, None, ())) as link:
        accepting.join()
        server.close()  # nobody to come back to
        assert isinstance(next_event(link), Lost)
        assert link.send(0x100, b"\1") is None


def stamps_of(events: Sequence[object]) -> list[float]:
    return [(one.message if isinstance(one, Sent) else one).timestamp for one in events]


def drained(link: Link, count: int) -> list[object]:
    """So many events, and what was sent after them."""
    return [next_event(link) for _ in range(count)] + [Sent(one) for one in link.untold()]


def test_what_is_sent_comes_between_what_came_before_and_after(line) -> None:
    """Nobody takes events while frames come and a request goes out: it is behind what came before,
    and before its answer."""
    master, path = line
    with Link(Bus("slcan", path, None, ()), echoes=True) as link:
        os.write(master, b"t1000\rt1010\r")
        first = [next_event(link) for _ in range(2)]
        os.write(master, b"t1020\r")
        time.sleep(0.05)  # read, and not taken yet
        sent = link.send(0x400, b"\1")
        os.write(master, b"t1030\r")
        events = first + drained(link, 3)
    ids = [getattr(one, "message", one).arbitration_id for one in events]
    assert ids == [0x100, 0x101, 0x102, 0x400, 0x103]
    assert events[3] == Sent(sent) and stamps_of(events) == sorted(stamps_of(events))


def test_what_is_sent_on_a_silent_bus_is_told(line) -> None:
    _, path = line
    with Link(Bus("slcan", path, None, ()), echoes=True) as link:
        sent = link.send(0x400, b"\1")
        assert next_event(link) == Sent(sent) and link.untold() == []
        last = link.send(0x401, b"")
        assert [*link.untold(), *stamps_of(drained(link, 0))] == [last]


def test_a_frame_that_was_not_sent_is_not_told(server: Server) -> None:
    accepting = threading.Thread(target=lambda: server.accept().close())
    accepting.start()
    with Link(Bus("slcan", server.channel, None, ()), echoes=True) as link:
        accepting.join()
        server.close()
        assert isinstance(next_event(link), Lost)
        assert link.send(0x100, b"\1") is None and link.untold() == []


def test_times_of_a_busy_multicast_bus_never_step_back() -> None:
    """A sender as fast as it can, our requests between, and a consumer that is late."""
    channel, frames, requests = "239.74.163.77", 2000, 40
    with (
        Link(Bus("udp_multicast", channel, None, (("port", 43177),)), echoes=True) as link,
        can.Bus(interface="udp_multicast", channel=channel, port=43177) as other,
    ):

        def stream() -> None:
            for number in range(frames):
                other.send(can.Message(arbitration_id=0x100, data=number.to_bytes(2, "big")))
                if number % 20 == 0:
                    time.sleep(1e-3)

        sender = threading.Thread(target=stream)
        sender.start()
        events: list[object] = []
        for _ in range(requests):
            assert link.send(0x400, b"\1") is not None
            time.sleep(2e-3)
            while (event := link.receive_now()) is not None:
                events.append(event)
        sender.join()
        while (event := link.receive(0.5)) is not None:
            events.append(event)
    stamps_s = stamps_of(events)
    assert stamps_s == sorted(stamps_s)
    assert sum(isinstance(one, Sent) for one in events) == requests
    assert len(events) > requests + frames // 2  # most came through


@pytest.mark.parametrize(("start_s", "is_shifted"), [(12.5, True), (None, False)])
def test_clocks_that_count_from_their_start_are_shifted(start_s, is_shifted: bool) -> None:
    """Two ends of python-can's virtual bus; the frames keep their distance."""
    channel = f"clocks-{start_s}"
    options = (("preserve_timestamps", True),)
    first_s = time.time() if start_s is None else start_s
    with (
        Link(Bus("virtual", channel, None, options)) as link,
        can.Bus(interface="virtual", channel=channel, preserve_timestamps=True) as other,
    ):
        for i in range(2):
            other.send(can.Message(arbitration_id=1, timestamp=first_s + 0.25 * i))
        stamps_s = [next_event(link).timestamp for _ in range(2)]
    assert stamps_s[1] - stamps_s[0] == pytest.approx(0.25, abs=1e-6)
    assert (stamps_s[0] != first_s) == is_shifted
    assert abs(stamps_s[0] - time.time()) < WAIT_S


def test_rate_is_of_the_last_second() -> None:
    seen = Seen(load().by_name["Motion"], times_s=[10.0 + 0.1 * i for i in range(30)])
    assert seen.rate_Hz(12.95) == 10.0
    assert seen.rate_Hz(20.0) == 0.0


# replay


LOGGED = (0x010, 0x100, 0x020, 0x108, 0x050, 0x400, 0x123, 0x100)


def log_of(path: Path, ids: Sequence[int] = LOGGED) -> Path:
    log = open_log(path, lambda: [])
    for i, frame_id in enumerate(ids):
        log.write(
            can.Message(
                timestamp=1000.0 + 0.01 * i,
                arbitration_id=frame_id,
                is_extended_id=False,
                data=bytes([i]),
            )
        )
    log.close()
    return path


def sent(master: int) -> list[int]:
    """Ids of the frames up to the C that closes the channel."""
    data = b""
    while not data.endswith(b"C\r"):
        data += os.read(master, 4096)
    return [int(one[1:4], 16) for one in data.split(b"\r") if one.startswith(b"t")]


@pytest.mark.parametrize(
    ("options", "ids"),
    [
        ([], [0x100, 0x108, 0x123, 0x100]),
        (["--only", "Status,0x123"], [0x100, 0x123, 0x100]),
        (["--only", "CurrentDemand"], []),
        (
            ["--include-commands", "--speed", "100"],
            list(LOGGED),
        ),
    ],
)
def test_replay_withholds_commands(line, tmp_path: Path, options, ids) -> None:
    master, path = line
    log = log_of(tmp_path / "a.log")
    result = run_quiesce(tmp_path, "can", "replay", log, "--bus", f"slcan:{path}", *options)
    assert result.returncode == 0, result.stderr
    assert sent(master) == ids
    assert f"{len(ids)} frames sent" in result.stderr
    is_whole = not options
    assert ("4 withheld" in result.stderr) == is_whole


def test_replay_withholds_by_the_shipped_ids_with_any_dbc(line, tmp_path: Path) -> None:
    """The controller takes what its own DBC says, whatever the log was of."""
    master, path = line
    dbc = tmp_path / "foreign.dbc"
    dbc.write_text(
        'VERSION ""\nBU_: ECU\nBO_ 16 Harmless: 4 ECU\n SG_ a : 0|8@1+ (1,0) [0|255] "" ECU\n'
    )
    log = log_of(tmp_path / "a.log", (0x010, 0x020, 0x050, 0x400, 0x101))
    options = ["--bus", f"slcan:{path}", "--dbc", dbc]
    for only in ([], ["--only", "Harmless,0x101"]):
        result = run_quiesce(tmp_path, "can", "replay", log, *options, *only)
        assert result.returncode == 0, result.stderr
        assert sent(master) == [0x101]


def test_replay_withholds_measurements_and_lock_step(line, tmp_path: Path) -> None:
    master, path = line
    ids = (
        0x011,
        0x030,
        0x037,
        0x040,
        0x043,
        0x5FF,
        0x600,
        0x601,
        0x603,
        0x608,
        0x620,
        0x6FF,
        0x700,
    )
    log = log_of(tmp_path / "a.log", ids)
    bus = ["--bus", f"slcan:{path}"]
    result = run_quiesce(tmp_path, "can", "replay", log, *bus)
    assert sent(master) == [0x5FF, 0x700] and "11 withheld" in result.stderr
    assert run_quiesce(tmp_path, "can", "replay", log, *bus, "--include-commands").returncode == 0
    assert sent(master) == list(ids)


def test_replay_of_a_damaged_log_sends_nothing(line, tmp_path: Path) -> None:
    master, path = line
    log = log_of(tmp_path / "a.log")
    log.write_text(log.read_text() + "garbage\n")
    result = run_quiesce(tmp_path, "can", "replay", log, "--bus", f"slcan:{path}")
    assert result.returncode == 2 and "line 9" in result.stderr
    os.set_blocking(master, False)
    with pytest.raises(BlockingIOError):
        os.read(master, 1)


def test_replay_over_udp(tmp_path: Path) -> None:
    channel, port = "239.74.163.2", random.Random(os.getpid()).randint(20000, 60000)
    try:
        bus = can.Bus(interface="udp_multicast", channel=channel, port=port)
    except (can.CanError, OSError) as error:
        pytest.skip(f"no network interface here has a route for multicast ({channel}): {error}")
    options = ["--bus", f"udp_multicast:{channel}", "--bus-option", f"port={port}"]
    with bus:
        log = log_of(tmp_path / "a.log")
        result = run_quiesce(tmp_path, "can", "replay", log, *options)
        assert result.returncode == 0, result.stderr
        ids = [bus.recv(WAIT_S).arbitration_id for _ in range(4)]
    assert ids == [0x100, 0x108, 0x123, 0x100]
