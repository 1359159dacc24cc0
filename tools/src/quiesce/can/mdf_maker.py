"""Makes an MDF4 file of a candump log in a process of its own: asammdf keeps Python's lock for half
a second at a time, and whoever reads a bus or sends a STOP is not to wait for that. To start that
process takes the lock, too: Python keeps it until the other program is loaded (vfork), some ms, and
on a busy machine as long as that one waits for the processor.
"""

import os
import pickle
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import one_line

NICE = 5  # who reads the bus goes first
MOST_TEXT = 200  # letters of why it failed
STDIN, STDOUT, STDERR = range(3)


@dataclass(frozen=True)
class Order:
    """What to make of which log."""

    log: Path
    target: Path
    has_frames: bool
    attachments: Sequence[tuple[str, bytes, str]]
    comment: str


@dataclass(frozen=True)
class Made:
    is_made: bool
    failure: str  # what is not in the file, or why there is none; empty: nothing


def make(order: Order) -> Made:
    """Waits for the other process. It goes on where this one is killed, and Ctrl-C is for this one:
    the file is completed."""
    given = pickle.dumps(order)
    # -P: a module in the folder at hand, such as a user's queue.py, is not to be taken for ours.
    command = [sys.executable, "-P", "-m", "quiesce.can.mdf_maker"]
    paths = os.pathsep.join(path for path in sys.path if path)
    try:
        done = subprocess.run(
            command,
            input=given,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": paths},
            start_new_session=True,
        )
    except OSError as error:
        return failed(order, error)
    if done.returncode:
        return failed(order, f"its making ended with code {done.returncode}")
    found: Made = pickle.loads(done.stdout)
    return found


def convert(order: Order) -> Made:
    """Here and now."""
    part = order.target.with_name(order.target.name + ".part.mf4")
    try:
        from quiesce.can.mdf import write_mdf
        from quiesce.can.readers import read_log

        frames = read_log(order.log) if order.has_frames else ()
        left_out = write_mdf(part, frames, order.attachments, order.comment)
        part.replace(order.target)
    except Exception as error:  # of asammdf, or the disk
        with suppress(OSError):
            part.unlink()
        return failed(order, error)
    if left_out:
        text = f"{left_out} remote or error frames are not in it; {order.log} has all frames"
        return Made(True, f"{order.target}: {text}")
    with suppress(OSError):
        order.log.unlink()
    return Made(True, "")


def failed(order: Order, why: object) -> Made:
    text = one_line(why)[:MOST_TEXT]
    return Made(False, f"{order.target}: {text}; the frames are in {order.log}")


def main() -> None:
    """Of the other process: an order on its standard input, what came of it on the output."""
    # By its name, not __main__'s: who reads the answer knows only that one.
    from quiesce.can import mdf_maker

    os.nice(NICE)
    answer = os.fdopen(os.dup(STDOUT), "wb")
    os.dup2(STDERR, STDOUT)  # asammdf prints what it stumbles over
    with os.fdopen(STDIN, "rb") as given:
        order: Order = pickle.load(given)
    with suppress(BrokenPipeError), answer:
        pickle.dump(mdf_maker.convert(order), answer)


if __name__ == "__main__":
    main()
