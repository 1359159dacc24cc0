"""Controllers that run by themselves, as the plant of a rig in the computer finds them: `quiesced`,
started here, or whatever a CAN channel leads to."""

import contextlib
import os
import resource
import subprocess
import tempfile
import tomllib
import tty
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.engine.linux_target import end_of, quiesced, running

BITRATE = 1_000_000  # of the bus that a pty stands for: its load is counted by it
INHERITED = "slcan:fd:"
CONTROLLER_PRIORITY, PLANT_PRIORITY = 80, 70


def is_open(number: str) -> bool:
    try:
        os.fstat(int(number))
    except (ValueError, OSError):
        return False
    return True


class Elsewhere:
    """A controller that somebody else has started. channel: of the bench's --can."""

    def __init__(self, channel: str) -> None:
        self.channel = self.name = channel

    @property
    def descriptors(self) -> Sequence[int]:
        """That the channel names: who started this program has opened it."""
        number = self.channel.removeprefix(INHERITED)
        return [int(number)] if number != self.channel and is_open(number) else []

    def __enter__(self) -> "Elsewhere":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    @property
    def failure(self) -> str:
        return ""


class Quiesced:
    """`quiesced` on a pty that stands for its bus; sensors, drivers and panel are on that, too.
    Entered, it runs, and keeps what it stores until it is left."""

    name = "quiesced"

    def __init__(self, board: Path | None) -> None:
        self._board = board
        self._open = ExitStack()
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> "Quiesced":
        program = quiesced()
        with ExitStack() as opening:
            master, slave = os.openpty()
            self._master = master
            opening.callback(self.hand_over)
            opening.callback(os.close, slave)
            tty.setraw(slave)
            place = tempfile.TemporaryDirectory(prefix="quiesce-")
            folder = Path(opening.enter_context(place))
            (folder / "state").mkdir()
            config, self._log = folder / "quiesced.toml", folder / "log"
            text = configuration(os.ttyname(slave), folder, self._board)
            config.write_text(text, encoding="utf-8")
            self._process = opening.enter_context(
                running([str(program), "--config", str(config)], self._log)
            )
            self._open = opening.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    @property
    def channel(self) -> str:
        return f"{INHERITED}{self._master}"

    @property
    def descriptors(self) -> Sequence[int]:
        return (self._master,)

    def hand_over(self) -> None:
        """The bench has the other end now, or nobody wants it any more."""
        if self._master >= 0:
            os.close(self._master)
            self._master = -1

    @property
    def failure(self) -> str:
        process = self._process
        if process is None or process.poll() is None:
            return ""
        return end_of("quiesced", process, self._log)


def may_be_real_time() -> bool:
    most, _ = resource.getrlimit(resource.RLIMIT_RTPRIO)
    is_enough = most == resource.RLIM_INFINITY or most >= CONTROLLER_PRIORITY
    return os.geteuid() == 0 or is_enough


def hurry(process_id: int) -> None:
    """Real-time priority for the plant where that is allowed: a controller that runs by itself
    does not wait for it."""
    with contextlib.suppress(OSError, AttributeError):  # where that is not allowed, or unknown
        os.sched_setscheduler(process_id, os.SCHED_FIFO, os.sched_param(PLANT_PRIORITY))


def configuration(line: str, folder: Path, board: Path | None) -> str:
    """quiesced.toml of a controller whose sensors, drivers and enable are on its bus."""
    wiring = '[accel]\nsource = "can"\n\n[current]\noutput = "can"\n'
    if board is not None:
        wiring = board_sections(board)
    priority = CONTROLLER_PRIORITY if may_be_real_time() else 0
    return f"""\
[loop]
priority = {priority}
lock_memory = false

[can]
interface = "slcan:{line}"
bitrate = {BITRATE}

[operator]
enable = "can"

[state]
folder = "{folder}/state"

[log]
to = "stderr"

{wiring}"""


def board_sections(board: Path) -> str:
    """UsageError where it is no board's file; whether it is a right one the bench says."""
    try:
        said: dict[str, Any] = tomllib.loads(board.read_text(encoding="utf-8"))
        sensors = [one["name"] for one in said["sensor"]]
        dampers = [one["name"] for one in said["damper"]]
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, KeyError, TypeError) as error:
        raise UsageError(f"{board}: no board: {one_line(error)}")
    rows = [f'[board]\nfile = "{board.resolve()}"\n']
    rows += [f'[[sensor]]\nname = "{name}"\nsource = "can"\n' for name in sensors]
    rows += [f'[[damper]]\nname = "{name}"\noutput = "can"\n' for name in dampers]
    return "\n".join(rows)
