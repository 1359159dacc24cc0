"""The guided session: 'quiesce commission' led from the page, in a process of its own, so that
nothing it computes keeps anybody from a STOP. docs/reference/led-protocol.md is what goes over its
pipes.

A person is the hand on the enable: on a bus the session is left, and the coil gets its safe
current, when the viewer who holds control is gone or lets go of it.
"""

import asyncio
import json
import math
import os
import subprocess
import sys
import threading
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.can.buses import Bus
from quiesce.live.relay import Relay
from quiesce.rig.access import Surroundings

MODULE = "quiesce.commission.led"
NAME = "the guided session"
KEYS = ({"begin", "is_one"}, {"answer", "of"}, {"leave"})
# Of its folder, what viewers may see.
PAGES = ("report.html", "before_after.html", "tuned/report.html")
GONE = "the session's process is gone; start the server anew"
END_S = 20.0  # to make the rig safe
STUCK_S = 15.0  # to leave: the controller's own stop is pressed after that
LOOK_S = 0.05


@dataclass(frozen=True)
class Plan:
    """What it is begun with. bus: where it finds the controller, relay: through which where only
    one program can have it; rig: the one in the computer that is on that bus, or None."""

    folder: Path
    given: Mapping[str, Any]
    bus: Bus
    relay: Relay | None = None
    rig: Surroundings | None = None

    @property
    def fds(self) -> tuple[int, ...]:
        return () if self.relay is None else (self.relay.theirs.fileno(),)

    def line(self) -> str:
        return json.dumps(
            {
                "folder": str(self.folder),
                "given": dict(self.given),
                "bus": {"lent_fd": self.fds[0]} if self.fds else asdict(self.bus),
                "is_simulated": self.rig is not None,
            }
        )


class Guide:
    """Entered, its process is there. obey(), let_go() and told() are called by one thread."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._steps: list[dict[str, str]] = []
        self._trouble = ""
        self._says = ""
        self._asks: dict[str, Any] | None = None
        self._asked = 0
        self._ended: dict[str, Any] | None = None  # how it did the last time
        self._begun = 0  # how often
        self._left_s: float | None = None  # since when it is to leave
        self._is_lost = False  # its process is, while it was at work
        self._writing = threading.Lock()
        self.is_at_work = False

    def __enter__(self) -> "Guide":
        paths = os.pathsep.join(path for path in sys.path if path)
        # -P: a module in the folder at hand is not to be taken for ours. Ctrl-C is for the server.
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", MODULE],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            bufsize=1,
            env={**os.environ, "PYTHONPATH": paths},
            start_new_session=True,
            pass_fds=self._plan.fds,
        )
        self._write(self._plan.line())
        self._readers = [
            threading.Thread(target=one, daemon=True) for one in (self._hear, self._hear_progress)
        ]
        for reader in self._readers:
            reader.start()
        return self

    def __exit__(self, *_: object) -> None:
        """It makes the rig safe before it ends; over a bus that is lent it needs end() for that."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.close()
        except OSError:
            pass  # it is gone already
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for reader in self._readers:
            reader.join()

    # What viewers ask for

    def obey(self, order: Mapping[str, Any]) -> None:
        """UsageError where that is no order, or not the time for it."""
        if set(order) not in KEYS:
            raise UsageError(f"an order to {NAME}: begin and is_one, answer and of, or leave")
        if "begin" in order:
            self._begin(order["begin"], order["is_one"])
        elif "answer" in order:
            self._answer(order["answer"], order["of"])
        else:
            self.leave()

    def _begin(self, step: Any, is_one: Any) -> None:
        if self.is_at_work:
            raise UsageError(f"{NAME} is under way already")
        if self._process.poll() is not None:
            raise UsageError(GONE)
        names = [one["name"] for one in self._steps]
        if not (step is None or step in names) or not isinstance(is_one, bool):
            raise UsageError(f"'begin' is null or of {', '.join(names)}, 'is_one' true or false")
        self._says, self._ended, self._left_s = "", None, None
        self._begun += 1
        self.is_at_work = True
        self._write(json.dumps({"begin": {"step": step, "is_one": is_one}}))

    def _answer(self, is_yes: Any, number: Any) -> None:
        asks = self._asks
        is_asked = asks is not None and asks["number"] == number and self._left_s is None
        if not is_asked or not isinstance(is_yes, bool):
            raise UsageError("that is not what is asked")
        self._asks = None
        self._write(json.dumps({"answer": is_yes}))

    def leave(self) -> None:
        if not self.is_at_work or self._left_s is not None:
            return
        self._left_s = time.monotonic()
        self._asks = None
        self._write(json.dumps({"leave": True}))

    async def end(self) -> None:
        """Left, and over."""
        self.leave()
        end_s = time.monotonic() + END_S
        while self.is_at_work and time.monotonic() < end_s:
            await asyncio.sleep(LOOK_S)

    def needs_stop(self) -> bool:
        """Once: its process is gone, or stuck, and may have left current behind on a bus."""
        is_stuck = self._left_s is not None and time.monotonic() > self._left_s + STUCK_S
        needs = self._is_lost or (self.is_at_work and is_stuck)
        if needs:
            self._is_lost, self._left_s = False, math.inf
        return needs and self._plan.rig is None

    def let_go(self) -> None:
        """Nobody holds control any more."""
        if self._plan.rig is None:
            self.leave()

    def told(self) -> dict[str, Any]:
        return {
            "folder": self._plan.folder.name,
            "steps": self._steps,
            "trouble": self._trouble,
            "begun": self._begun,
            "is_at_work": self.is_at_work,
            "is_leaving": self.is_at_work and self._left_s is not None,
            "says": self._says,
            "asks": self._asks,
            "ended": self._ended,
            "pages": [one for one in PAGES if (self._plan.folder / one).is_file()],
        }

    def page(self, name: str) -> Path | None:
        """A file that viewers may see; None: there is no such one."""
        file = self._plan.folder / name
        return file if name in PAGES and file.is_file() else None

    # What its process says

    def _write(self, line: str) -> None:
        assert self._process.stdin is not None
        try:
            with self._writing:
                self._process.stdin.write(line + "\n")
        except (OSError, ValueError):
            pass  # gone: that is told where it ends

    def _hear(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            try:
                self._take(json.loads(line))
            except ValueError:  # not its own any more: without it nobody could be asked
                self._process.kill()
        self._process.wait()
        self._is_lost = self.is_at_work
        if self.is_at_work or self._process.returncode:
            why = self._says or f"code {self._process.returncode}"
            self._ended = {"is_ok": False, "text": f"{GONE} ({why})"}
        self._asks = None
        self.is_at_work = False

    def _take(self, said: dict[str, Any]) -> None:
        if "steps" in said:
            self._steps, self._trouble = said["steps"], said["trouble"]
        elif "says" in said:
            self._says = said["says"]
        elif "asks" in said:
            self._asked += 1
            self._asks = {**said["asks"], "number": self._asked}
        elif "order" in said:
            self._write(json.dumps({"rig": self._of_rig(**said["order"])}))
        elif "ended" in said:
            self._ended, self._asks = said["ended"], None
            self.is_at_work = False

    def _of_rig(self, number: int, what: dict[str, Any] | None) -> dict[str, Any]:
        rig = self._plan.rig
        try:
            if rig is None:
                return {"number": number, "refused": "there is no rig in the computer"}
            if what is None:
                return {"number": number, "state": rig.next_state()}
            rig.order(**what)
            return {"number": number, "done": True}
        except UsageError as error:
            return {"number": number, "refused": str(error)}
        except BenchFailure as error:
            return {"number": number, "gone": str(error)}

    def _hear_progress(self) -> None:
        """Of what takes long: lines on its standard error."""
        assert self._process.stderr is not None
        for line in self._process.stderr:
            if text := one_line(line):
                self._says = text
