"""STOP: from the click in a browser to a safe demand on the bus, alone and beside seven others."""

import contextlib
import json
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.errors import BenchFailure
from quiesce.can.database import load
from websockets.exceptions import ConnectionClosed

from quiesce_benchmarks.live.browser import Browser, opened
from quiesce_benchmarks.live.rig import PATIENCE_S, Network, Node, Page, on_network
from quiesce_benchmarks.live.usage import busy
from quiesce_benchmarks.part import Effort, Measured

TITLE = "stopping: from the click to a safe demand on UDP multicast"
FIGURES = (
    ("stop_ms_p99", "ms", 20.0, "lower", False),
    ("stop_ms_p99_8_viewers", "ms", 50.0, "lower", False),
    ("viewers", "1", 8.0, "higher"),
)
CLICKS, QUICK_CLICKS = 30, 5
VIEWERS = 8
DEMAND = "CurrentDemand"
PAUSE_S = 0.3  # the driver is on for so long before the next click


def measure(effort: Effort) -> Measured:
    clicks = QUICK_CLICKS if effort.is_quick else CLICKS
    with tempfile.TemporaryDirectory() as name, on_network(Path(name), "--raw") as rig:
        node, network, page = rig
        with opened(page.address) as browser:
            alone_ms = [one_stop(node, network, browser) for _ in range(clicks)]
            with others(page, VIEWERS - 1) as count:
                beside_ms = [one_stop(node, network, browser) for _ in range(clicks)]
                viewers = 1 + count()
    values = {
        "stop_ms_p99": float(np.percentile(alone_ms, 99)),
        "stop_ms_p99_8_viewers": float(np.percentile(beside_ms, 99)),
        "viewers": float(viewers),
    }
    reported = {"clicks": clicks, "machine": busy(), "alone_ms": alone_ms, "beside_ms": beside_ms}
    return Measured(values, reported)


def one_stop(node: Node, network: Network, browser: Browser) -> float:
    """Milliseconds. The controller starts anew: a stopped one stays stopped."""
    network.end()
    node.stop()
    node.start()
    network.start()
    with network.listen() as bus:
        wait_demand(bus, is_on=True)
        time.sleep(PAUSE_S)
        while bus.recv(0.0) is not None:
            pass
        pressed_ms = browser.do("click")["pressed_ms"]
        return 1000 * wait_demand(bus, is_on=False, after_s=pressed_ms / 1000) - pressed_ms


def wait_demand(bus: Any, is_on: bool, after_s: float = 0.0) -> float:
    """When the first demand came with the driver on, or off."""
    database = load()
    frame_id = database.by_name[DEMAND].frame_id
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        frame = bus.recv(1.0)
        if frame is None or frame.arbitration_id != frame_id or frame.timestamp < after_s:
            continue
        if bool(database.raw(frame_id, bytes(frame.data))["driver_is_enabled"]) == is_on:
            return float(frame.timestamp)
    raise BenchFailure(f"no demand with the driver {'on' if is_on else 'off'}")


@contextlib.contextmanager
def others(page: Page, count: int) -> Iterator[Any]:
    """So many viewers who draw eight signals and read all; yields how many still do."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(page.viewer()) for _ in range(count)]
        threads = [threading.Thread(target=read_all, args=(one,), daemon=True) for one in sockets]
        for thread in threads:
            thread.start()
        yield lambda: sum(thread.is_alive() for thread in threads)


def read_all(socket: Any) -> None:
    series = json.loads(socket.recv(PATIENCE_S))["hello"]["series"]
    fast = [one["number"] for one in series if one["message"] in (DEMAND, "RawSample")]
    socket.send(json.dumps({"do": "show", "series": fast}))
    with contextlib.suppress(ConnectionClosed):
        while True:
            socket.recv()
