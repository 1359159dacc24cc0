"""What a viewer says over his websocket, and what he waits for: docs/reference/live-protocol.md."""

import json
import time
from collections.abc import Callable
from typing import Any

from quiesce.base.errors import BenchFailure
from websockets.sync.client import ClientConnection

from quiesce_benchmarks.live.rig import PATIENCE_S


def say(viewer: ClientConnection, do: str, **more: Any) -> None:
    viewer.send(json.dumps({"do": do, **more}))


def heard(viewer: ClientConnection, kind: str, accept: Callable[[Any], object]) -> Any:
    """The next text message of that kind that is accepted. BenchFailure where none comes."""
    end_s = time.monotonic() + PATIENCE_S
    while (left_s := end_s - time.monotonic()) > 0.0:
        message = viewer.recv(left_s)
        said = {} if isinstance(message, bytes) else json.loads(message)
        if kind in said and accept(said[kind]):
            return said[kind]
    raise BenchFailure(f"the page says no such {kind}")
