"""A commissioning that is led by another program, in a process of its own: `python -m
quiesce.commission.led`. JSON lines on standard input and output, docs/reference/led-protocol.md.

It ends with its input. Whatever drives the coil then is over first, as at Ctrl-C.
"""

import json
import os
import queue
import signal
import threading
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TextIO

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.can.buses import Bus
from quiesce.can.lent import lent_bus
from quiesce.can.link import Link
from quiesce.can.tables import CRC
from quiesce.commission.by_hand import site_on_bus
from quiesce.commission.folder import Folder
from quiesce.commission.hand import Left
from quiesce.commission.run import Order, commission, listed
from quiesce.commission.simulated import TABLE, SimulatedSite
from quiesce.commission.site import Site, give, until_idle
from quiesce.commission.steps import NAMES, STEPS
from quiesce.commission.wants import Wants, wants_of
from quiesce.loading.load import put
from quiesce.loading.sources import table_of
from quiesce.rig import Rig
from quiesce.table.kinds import PULSES

STDIN, STDOUT, STDERR = range(3)
RIG_S = 15.0  # for the rig's answer
LEFT = "left; it goes on with the step that was under way"


@dataclass(frozen=True)
class Setup:
    """The first line."""

    folder: Path
    given: Mapping[str, Any]  # of Wants
    bus: Bus
    is_simulated: bool  # who leads has the rig that is on that bus


class Leader:
    """Who leads, at the other end of two pipes."""

    def __init__(self, out: TextIO) -> None:
        self.begins: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()  # None: the end
        self.is_at_work = False
        self._out = out
        self._answers: queue.SimpleQueue[bool] = queue.SimpleQueue()
        self._replies: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self._orders = 0
        self._wants_out = False

    def hear(self, given: TextIO) -> None:
        """In a thread of its own, until there is no more. What is no line of its is left out."""
        try:
            for line in given:
                with suppress(ValueError, AttributeError, RecursionError):
                    for key, value in json.loads(line).items():
                        self._take(key, value)
        finally:
            self._leave()
            self.begins.put(None)

    def _take(self, key: str, value: Any) -> None:
        if key == "begin" and isinstance(value, dict):
            self._wants_out = False
            self.begins.put(value)
        elif key == "answer":
            self._answers.put(value)
        elif key == "rig":
            self._replies.put(value)
        elif key == "leave":
            self._leave()

    def _leave(self) -> None:
        """As Ctrl-C does, and where that comes to nothing, at the next thing that is told."""
        self._wants_out = True
        os.kill(os.getpid(), signal.SIGINT)

    def interrupted(self, *_: object) -> None:
        """The handler of SIGINT. Once: what makes the rig safe after that is left alone."""
        if self.is_at_work:
            self.is_at_work = False
            raise KeyboardInterrupt

    def start(self) -> None:
        """Left where that was wanted before it came to this."""
        self.is_at_work = True
        self.require_stay()

    def require_stay(self) -> None:
        if self._wants_out:
            raise Left("left")

    def tell(self, **what: Any) -> None:
        self._out.write(json.dumps(what, default=float) + "\n")
        self._out.flush()

    def says(self, text: str) -> None:
        """Left where he wants that."""
        self.tell(says=text)
        self.require_stay()

    # As a Hand

    def do(self, text: str) -> None:
        self._ask(text, False)

    def allow(self, text: str) -> None:
        self._ask(text, True)

    def _ask(self, text: str, is_hazard: bool) -> None:
        self.require_stay()
        while not self._answers.empty():
            self._answers.get()  # to a question that was left
        self.tell(asks={"text": text, "is_hazard": is_hazard})
        if self._answers.get() is not True:
            raise Left("not allowed" if is_hazard else "left")

    # As what is around a controller in the computer, which he has

    def __enter__(self) -> "Leader":
        return self

    def __exit__(self, *_: object) -> None:
        """It is his."""

    def order(self, **what: Any) -> None:
        self._of_rig(what)

    def next_state(self) -> dict[str, Any]:
        state: dict[str, Any] = self._of_rig(None)["state"]
        return state

    def _of_rig(self, order: dict[str, Any] | None) -> dict[str, Any]:
        """What is answered to an order; None: the next state. UsageError where it is refused,
        BenchFailure where the rig is gone."""
        self._orders += 1
        self.tell(order={"number": self._orders, "what": order})
        reply: dict[str, Any] = {}
        while reply.get("number") != self._orders:  # one that was interrupted comes late
            try:
                reply = self._replies.get(timeout=RIG_S)
            except queue.Empty:
                raise BenchFailure("the rig does not answer")
        if "refused" in reply:
            raise UsageError(reply["refused"])
        if "gone" in reply:
            raise BenchFailure(reply["gone"])
        return reply


class LentSite(SimulatedSite):
    """On a rig that goes on between two steps, and may be another one than at the step before."""

    def __enter__(self) -> "LentSite":
        with ExitStack() as undo:
            undo.push(super().__exit__)
            super().__enter__()
            undo.push(self._at_rest)
            self._bring_back()
            undo.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        try:
            self._at_rest()
        finally:
            super().__exit__(*error)

    def _at_rest(self, *_: object) -> None:
        self.rig.write("rig/control", False)
        self.rig.write("rig/drive_V", 0.0)
        self.rig.turn_over(0.0)

    def _bring_back(self) -> None:
        if not until_idle(self.rig):
            raise BenchFailure("the controller still runs without its enable")
        give(self.rig, self._folder.settings)
        file = self._folder.path / TABLE
        if file.is_file():
            table, tables = table_of(PULSES.name, file), self.rig.tables()
            if tables.info(table.road, CRC) != table.crc:
                put(tables, table, lambda _: None)


def site_of(setup: Setup, leader: Leader, wants: Wants, folder: Folder) -> Site:
    if setup.is_simulated:
        return LentSite(Rig(Link(setup.bus), leader), wants, folder)
    return site_on_bus(Rig(Link(setup.bus)), leader, wants, folder)


def serve(setup: Setup, leader: Leader) -> None:
    tell_steps(setup.folder, leader)
    while (begin := leader.begins.get()) is not None:
        try:
            is_ok, text = led(setup, leader, begin)
        except KeyboardInterrupt:
            is_ok, text = False, LEFT
        tell_steps(setup.folder, leader)
        leader.tell(ended={"is_ok": is_ok, "text": text})


def led(setup: Setup, leader: Leader, begin: Mapping[str, Any]) -> tuple[bool, str]:
    """begin: `step` to go back to, or None; `is_one`: no further than the step that is next. How it
    ended."""
    try:
        leader.start()
        require_its_kind(setup)
        step = begin.get("step")
        if step is not None and step not in NAMES:
            raise UsageError(f"step {step!r}: there are {', '.join(NAMES)}")
        end = next_step(setup.folder, step) if begin.get("is_one") else None
        order = Order(setup.folder, setup.given, step, end, False)
        commission(
            order,
            leader.says,
            partial(site_of, setup, leader),
            lambda _: tell_steps(setup.folder, leader),
        )
        return True, "done"
    except Left:
        return False, LEFT
    except (UsageError, BenchFailure) as error:
        return False, str(error)
    except BrokenPipeError:
        raise  # nobody leads any more
    except OSError as error:
        return False, f"{error.filename or setup.folder}: {error.strerror or error}"
    finally:
        leader.is_at_work = False


def require_its_kind(setup: Setup) -> None:
    """UsageError where the folder was begun with another kind of rig: nothing of it is given up
    for this one."""
    before = Folder(setup.folder).wants
    was_simulated = before.get("plant") is not None
    if before and was_simulated != setup.is_simulated:
        which = "a rig in the computer" if was_simulated else "a controller on a bus"
        raise UsageError(f"this folder was begun with {which}; name another one")


def next_step(folder: Path, begin: str | None) -> str:
    done = Folder(folder).results
    return begin or next((one.NAME for one in STEPS if one.NAME not in done), STEPS[-1].NAME)


def tell_steps(folder: Path, leader: Leader) -> None:
    titles = [one.TITLE for one in STEPS]
    try:
        found = listed(Folder(folder))
    except UsageError as error:
        leader.tell(steps=[], trouble=str(error))
        return
    steps = [
        {"name": name, "title": title, "line": line}
        for (name, line), title in zip(found, titles, strict=True)
    ]
    leader.tell(steps=steps, trouble="")


def bus_of(said: Mapping[str, Any]) -> Bus:
    if "lent_fd" in said:
        return lent_bus(said["lent_fd"])
    options = tuple((key, value) for key, value in said["options"])
    return Bus(said["interface"], said["channel"], said["bitrate"], options)


def setup_of(line: str) -> Setup:
    """UsageError where it is none."""
    try:
        said = json.loads(line)
        wants = vars(wants_of(Wants().data() | said["given"]))
        given = {name: wants[name] for name in said["given"]}
        return Setup(Path(said["folder"]), given, bus_of(said["bus"]), bool(said["is_simulated"]))
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise UsageError(f"the first line is not whole: {type(error).__name__}: {one_line(error)}")


def main() -> None:
    out = os.fdopen(os.dup(STDOUT), "w", encoding="utf-8")
    os.dup2(STDERR, STDOUT)  # what a library prints is no line of ours
    given = os.fdopen(STDIN, encoding="utf-8")
    leader = Leader(out)
    signal.signal(signal.SIGINT, leader.interrupted)
    try:
        setup = setup_of(given.readline())
    except UsageError as error:
        leader.tell(ended={"is_ok": False, "text": str(error)})
        return
    threading.Thread(target=leader.hear, args=(given,), daemon=True).start()
    try:
        serve(setup, leader)
    except BrokenPipeError:
        pass  # nobody leads any more
    except Exception as error:
        leader.tell(ended={"is_ok": False, "text": f"the session's own mistake: {one_line(error)}"})
        raise


if __name__ == "__main__":
    main()
