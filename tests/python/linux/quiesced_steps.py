"""What tests do with a running `quiesced` and with its bus."""

import os
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

from quiesced_peer import ROOT, Peer, Quiesced

# States of the controller, its fault, results of a service.
IDLE, RUN, SAFE, FAULT = 1, 2, 3, 4
ESTOP = 10
DONE, STORE_FAILED = 0, 5


def start_running(quiesced: Quiesced, *arguments: str) -> None:
    quiesced.peer.operator = {"enable": 1}
    quiesced.start(*arguments)
    quiesced.peer.wait_state(RUN)


def disarm(quiesced: Quiesced) -> None:
    """Lets go: only then may all parameters change."""
    after = quiesced.peer.count()
    quiesced.peer.operator = {"enable": 0}
    quiesced.peer.wait_state(IDLE, after)


def in_a_row(count: int, state: int) -> Callable[[dict[str, int]], bool]:
    """Accepts the last of so many demand frames in a row with a state."""
    seen = 0

    def accept(signals: dict[str, int]) -> bool:
        nonlocal seen
        seen = seen + 1 if signals["state"] == state else 0
        return seen == count

    return accept


def set_parameter(peer: Peer, name: str, value: int) -> None:
    assert peer.request("STAGE", index_of(name), value).signals["result"] == DONE
    assert peer.request("APPLY").signals["result"] == DONE


def read_parameter(peer: Peer, name: str) -> int:
    reply = peer.request("READ", index_of(name))
    assert reply.signals["result"] == DONE
    return reply.signals["param_value"]


def index_of(name: str) -> int:
    header = ROOT / "docs/reference/parameters.md"
    row = next(r for r in header.read_text().splitlines() if f"`{name}`" in r)
    return int(row.split("|")[1])


def killed(quiesced: Quiesced) -> int:
    """Number of frames up to the death of a controller that was running."""
    quiesced.signal(signal.SIGKILL)
    assert quiesced.wait() == -signal.SIGKILL
    return quiesced.peer.count()


def wait_farewell(peer: Peer, after: int, current_mA: int) -> None:
    off = peer.wait("CurrentDemand", lambda s: s["driver_is_enabled"] == 0, after)
    assert off.signals["current_cmd_mA"] == current_mA


def hang_up(quiesced: Quiesced) -> None:
    """Closes the pty's master side for good."""
    null = os.open("/dev/null", os.O_RDWR)
    os.dup2(null, quiesced.peer.master)
    os.close(null)


def preload(folder: Path, name: str, code: str) -> str:
    """Builds a library whose functions come before those of the C library."""
    library = folder / f"{name}.so"
    (folder / f"{name}.c").write_text(code)
    build = ["cc", "-shared", "-fPIC", "-O1", "-o", library, folder / f"{name}.c", "-ldl"]
    subprocess.run(build, check=True)
    return str(library)
