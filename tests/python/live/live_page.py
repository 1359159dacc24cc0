"""Viewers of `quiesce live` over real websockets."""

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from can_bus import Controller
from quiesce.live.protocol import BLOCK, HEAD
from quiesce_benchmarks.live import rig
from quiesce_benchmarks.live.rig import PATIENCE_S
from websockets.sync.client import ClientConnection


@dataclass(frozen=True)
class Samples:
    """A block of a packet."""

    frame_id: int
    first: int
    times_s: np.ndarray
    columns: dict[int, np.ndarray]


@dataclass(frozen=True)
class Packet:
    number: int
    sent_s: float
    newest_s: float
    blocks: list[Samples]


def packet_of(data: bytes) -> Packet:
    """As docs/reference/live-protocol.md has it."""
    kind, version, count, number, sent_s, newest_s = HEAD.unpack_from(data)
    assert (kind, version) == (1, 1)
    at, blocks = HEAD.size, []

    def take(dtype: str, length: int) -> np.ndarray:
        nonlocal at
        found = np.frombuffer(data, dtype, length, at)
        at += found.nbytes
        return found

    for _ in range(count):
        frame_id, width, length, first, start_s = BLOCK.unpack_from(data, at)
        at += BLOCK.size
        numbers = take("<u4", width)
        times_s = start_s + take("<i4", length) * 1e-6
        columns = {int(one): take("<f4", length) for one in numbers}
        blocks.append(Samples(frame_id, first, times_s, columns))
    assert at == len(data)
    return Packet(number, sent_s, newest_s, blocks)


class Viewer:
    """One websocket."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.packets: list[Packet] = []
        self.hello = self.until("hello")

    def ask(self, do: str, **more: Any) -> None:
        self.socket.send(json.dumps({"do": do, **more}))

    def until(self, kind: str, accept: Callable[[Any], bool] = lambda _: True) -> Any:
        """The next text message of that kind that is accepted. Packets meanwhile are kept."""
        end_s = time.monotonic() + PATIENCE_S
        while (left_s := end_s - time.monotonic()) > 0.0:
            message = self.socket.recv(left_s)
            if isinstance(message, bytes):
                self.packets.append(packet_of(message))
                continue
            said = json.loads(message)
            if kind in said and accept(said[kind]):
                return said[kind]
        raise AssertionError(f"no such {kind}")

    def note(self) -> dict[str, Any]:
        return self.until("note")

    def watch(self, packets: int) -> list[Packet]:
        """So many packets from now on."""
        self.packets.clear()
        while len(self.packets) < packets:
            message = self.socket.recv(PATIENCE_S)
            if isinstance(message, bytes):
                self.packets.append(packet_of(message))
        return self.packets

    def series(self, message: str, signal_name: str) -> int:
        return next(
            one["number"]
            for one in self.hello["series"]
            if (one["message"], one["signal"]) == (message, signal_name)
        )

    def every_ms(self) -> list[int]:
        """The eight signals that this controller sends at 1 kHz."""
        drawn = (one for one in self.hello["series"] if one["message"] in FAST)
        return [one["number"] for one in drawn]


FAST = ("CurrentDemand", "RawSample")


def pull(controller: Controller) -> None:
    """Its cable; the name goes, too: its number may be that of another test's line at once."""
    controller.stop()
    controller.path.unlink()


class Page(rig.Page):
    """A running `quiesce live`, with viewers who understand what they are sent."""

    @contextmanager
    def viewer(self, **options: Any) -> Iterator[Viewer]:  # type: ignore[override]
        with super().viewer(**options) as socket:
            yield Viewer(socket)
