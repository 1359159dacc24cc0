"""One viewer's websocket: what he is sent, what he asks for."""

import asyncio
import json
import time
from collections.abc import Coroutine
from dataclasses import asdict
from typing import Any

from fastapi import WebSocket, WebSocketDisconnect

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.live.desk import Before
from quiesce.live.jobs import change, store, wanted
from quiesce.live.law_view import View, look
from quiesce.live.protocol import MOST_MALFORMED, Command, Malformed, command_of, pack_samples
from quiesce.live.recordings import ask_tables
from quiesce.live.room import Room
from quiesce.live.series import preferred
from quiesce.live.spectrum import SpectrumPlan
from quiesce.live.tables import TablePart, Upload, use

MOST_NOTES = 100  # that wait for a viewer who does not read
SPECTRUM_BEATS = 10
TOLD_BEATS = 5  # all that is no sample: every so many beats
TOO_MANY_MALFORMED = 1008


class Viewer:
    """serve() until he is gone. Only send_all() writes to the socket."""

    def __init__(self, socket: WebSocket, room: Room, number: int) -> None:
        self._socket = socket
        self._room = room
        self._desk = room.desk
        self._number = number
        self._shown: tuple[int, ...] | None = None  # None: nothing was chosen yet
        self._cursors = room.desk.start_of_history()
        self._spectrum: SpectrumPlan | None = None  # None: he wants none
        self._notes: list[dict[str, Any]] = []
        self._values: list[int] | None = None  # of the parameters, as he was told
        self._before: Before | None = None
        self._law: View | None = None  # as he was told
        self._upload = Upload()
        self._packets = 0
        self._malformed = 0
        self._works: set[asyncio.Task[Any]] = set()

    async def serve(self) -> None:
        both = [asyncio.create_task(one) for one in (self._send_all(), self._receive_all())]
        try:
            await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in both:
                task.cancel()
            ends = await asyncio.gather(*both, return_exceptions=True)
        for end in ends:
            if isinstance(end, Exception) and not isinstance(end, WebSocketDisconnect):
                raise end

    # What he asks for

    async def _receive_all(self) -> None:
        while self._malformed < MOST_MALFORMED:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            try:
                self._obey(command_of(message.get("text"), len(self._desk.series)))
            except Malformed as error:
                self._malformed += 1
                self._note(False, f"not understood: {error}")
        await self._socket.close(TOO_MANY_MALFORMED, "not one of ours")

    def _obey(self, command: Command) -> None:
        room = self._room
        if command.do == "stop":
            room.stop()
        elif command.do == "show":
            self._shown = command.series
        elif command.do == "spectrum":
            self._spectrum = command.spectrum
        elif command.do == "release":
            room.release(self._number)
        elif command.do == "take":
            if not room.control.take(self._number):
                self._note(False, f"viewer {room.control.holder} holds control")
        elif command.do == "mark":
            self._start(command)
        elif room.control.holder != self._number:
            self._note(False, "take control first", command.do)
        elif command.do == "guide":
            self._lead(command.order)
        else:
            self._start(command)
        room.tell_now()

    def _lead(self, order: dict[str, Any]) -> None:
        """At once: what he does next finds it done."""
        try:
            self._room.lead(order)
        except UsageError as error:
            self._note(False, str(error), "guide")

    def _start(self, command: Command) -> None:
        """A change takes a while; meanwhile he may ask for other things, and stop."""
        self._run(self._work(command))

    def _run(self, work: Coroutine[Any, Any, Any]) -> None:
        task = asyncio.create_task(work)
        self._works.add(task)
        task.add_done_callback(self._works.discard)

    async def _work(self, command: Command) -> None:
        try:
            is_done, text = await self._do(command)
        except (BenchFailure, UsageError) as error:
            is_done, text = False, str(error)
        if text:
            self._note(is_done, text, command.do)

    async def _do(self, command: Command) -> tuple[bool, str]:
        """Whether it came about, and a line about it. UsageError for values not allowed."""
        if command.do == "rig":
            return await self._order(command.order)
        desk, jobs = self._desk, self._desk.jobs
        if command.do in ("record", "end_record", "mark"):
            return True, self._record(command)
        if command.table is not None:
            return await self._load(command.table)
        if command.do == "law":
            return await jobs.run("fetching the law's table", look(desk.show_law))
        values = desk.preamble.values
        if not values or not desk.preamble.may_ask:
            why = desk.preamble.misunderstood or "the controller's parameters are not read yet"
            return False, why
        if command.do == "save":
            is_done, text = await jobs.run("storing", store)
            if is_done:
                desk.before = Before(list(values), is_saved=True)
            return is_done, text
        settings = self._settings(command, values)
        if not settings:
            return True, "nothing differs"
        return await jobs.run("a change", change(values, settings))

    async def _order(self, order: dict[str, Any]) -> tuple[bool, str]:
        if self._room.rig is None:
            return False, "this is no rig in the computer: nothing here can be ordered"
        if self._desk.jobs.is_held:
            return False, f"wait: {self._desk.jobs.name} is under way"
        return True, await asyncio.to_thread(self._room.rig.obey, order)

    async def _load(self, part: TablePart) -> tuple[bool, str]:
        """Nothing to say before the last part. UsageError where they do not follow each other."""
        data = self._upload.take(part)
        if data is None:
            return True, ""
        return await self._desk.jobs.run("loading a table", use(part.kind, part.name, data))

    def _record(self, command: Command) -> str:
        """A line about it. UsageError where it cannot be."""
        desk = self._desk
        if command.do == "mark":
            return desk.recordings.mark(command.text)
        if command.plan is None:
            return desk.recordings.end()
        text = desk.recordings.begin(command.plan, desk.rings, desk.series)
        if desk.preamble.may_ask:
            self._run(desk.jobs.run("reading which tables are in use", ask_tables))
        return text

    def _settings(self, command: Command, values: list[int]) -> dict[int, int]:
        if command.do == "set":
            return wanted(command.settings, values)
        both = enumerate(zip(values, self._desk.before.values, strict=True))
        return {index: want for index, (value, want) in both if value != want}

    def _note(self, is_ok: bool, text: str, of: str = "") -> None:
        """of: the command that it is about."""
        if len(self._notes) < MOST_NOTES:
            self._notes.append({"note": {"is_ok": is_ok, "text": text, "of": of}})
        self._room.tell_now()

    # What he is sent

    async def _send_all(self) -> None:
        await self._send_text({"hello": {**self._room.hello, "viewer": self._number}})
        told_beat = -TOLD_BEATS
        while True:
            beat = await self._room.next_beat()
            notes, self._notes = self._notes, []
            if notes or self._room.is_news or beat - told_beat >= TOLD_BEATS:
                told_beat = beat
                await self._send_text({"state": self._room.told()})
                await self._send_parameters()
                await self._send_law()
            for note in notes:  # after what they are about
                await self._send_text(note)
            if self._spectrum is not None and beat % SPECTRUM_BEATS == 0:
                await self._send_text({"spectrum": self._desk.spectrum_told(self._spectrum)})
            await self._socket.send_bytes(self._packet())

    async def _send_parameters(self) -> None:
        values, before = self._desk.preamble.values, self._desk.before
        if values is not self._values or before is not self._before:
            self._values, self._before = values, before
            await self._send_text({"parameters": {"values": values, "before": asdict(before)}})

    async def _send_law(self) -> None:
        if self._desk.law is not self._law:
            self._law = self._desk.law
            await self._send_text({"law": self._law})

    def _packet(self) -> bytes:
        shown = self._shown
        if shown is None:
            shown = tuple(preferred(self._desk.series, self._desk.heard))
        blocks = list(self._desk.blocks(shown, self._cursors))
        self._packets += 1
        return pack_samples(self._packets - 1, time.time(), self._desk.newest_s, blocks)

    async def _send_text(self, value: dict[str, Any]) -> None:
        await self._socket.send_text(json.dumps(value, allow_nan=False))
