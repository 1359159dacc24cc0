"""The bus goes away and comes back, again and again: the same viewer sees both, and samples."""

import json
import tempfile
import time
from pathlib import Path
from typing import Any

from quiesce_benchmarks.live.rig import PATIENCE_S, Node, Page, node_program
from quiesce_benchmarks.part import Effort, Measured

TITLE = "losing: the bus (a pty) goes away and comes back"
LOSSES = 100
FIGURES = (("bus_losses_survived", "1", float(LOSSES), "higher"),)


def measure(effort: Effort) -> Measured:
    survived = 0
    with tempfile.TemporaryDirectory() as name:
        node = Node(node_program(), Path(name))
        node.start()
        page = Page(Path(name), "--bus", node.bus)
        try:
            with page.viewer() as socket:
                for number in range(1, LOSSES + 1):
                    node.stop()
                    is_lost = sees(socket, lambda bus, n=number: bus["losses"] == n)
                    node.start()
                    survived += is_lost and sees(socket, is_back)
        finally:
            page.end()
            node.stop()
    return Measured({"bus_losses_survived": float(survived)}, {"losses": LOSSES})


def is_back(bus: dict[str, Any]) -> bool:
    return bus["is_up"] and bus["status_age_s"] is not None and bus["status_age_s"] < 0.3


def sees(socket: Any, accept: Any) -> bool:
    """Whether the viewer is told so."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        message = socket.recv(PATIENCE_S)
        if isinstance(message, str):
            state = json.loads(message).get("state")
            if state is not None and accept(state["bus"]):
                return True
    return False
