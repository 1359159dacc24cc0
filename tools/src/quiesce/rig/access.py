"""A rig by its variables: read, write, capture, and shake it where it is in the computer."""

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any, Protocol

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.can.buses import Bus
from quiesce.can.changes import apply
from quiesce.can.database import Database, load
from quiesce.can.e2e import JUMPED, OK
from quiesce.can.emergency import press
from quiesce.can.link import Link
from quiesce.can.parameters import settings_of, text_of
from quiesce.can.services import DONE, TRIES, Services, no_answer
from quiesce.can.tables import Tables
from quiesce.can.traffic import Traffic
from quiesce.engine.params import parameters
from quiesce.rig.capture import Capture, Series, Trigger, Value
from quiesce.rig.variables import Variable, catalogue, named

READ_S = 3.0  # the slowest message comes once a second
LOOK_S = 0.02
MOST_S = 3600.0
SIMULATION_TRIES = 10 * TRIES  # a busy computer may leave its rig without time for seconds


class Surroundings(Protocol):
    """What is around a controller in the computer: rig.simulation has it."""

    def __enter__(self) -> Any: ...
    def __exit__(self, *_: object) -> None: ...
    def order(self, **what: Any) -> None: ...
    def next_state(self) -> dict[str, Any]: ...


class Rig:
    """Not thread-safe. Entered, it is at work; UsageError where its bus cannot be opened."""

    def __init__(self, link: Link, simulation: Surroundings | None = None) -> None:
        """simulation: the rig on that bus, where it is in the computer; entered here."""
        self._link = link
        self._simulation = simulation
        self._database: Database = load()
        self._traffic = Traffic(self._database)
        tries = TRIES if simulation is None else SIMULATION_TRIES
        self._services = Services(link, self._database, self._take, tries)
        self._known = catalogue(self._database, simulation is not None)
        self._by_frame: dict[int, list[Variable]] = {}
        for one in self._known.values():
            self._by_frame.setdefault(one.frame_id, []).append(one)
        self._on_value: Callable[[str, float, Value], None] | None = None
        self._open = ExitStack()

    def __enter__(self) -> "Rig":
        with ExitStack() as opening:
            if self._simulation is not None:
                opening.enter_context(self._simulation)
            opening.enter_context(self._link)
            self._open = opening.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    @property
    def bus(self) -> Bus:
        """Where other programs find it, too."""
        return self._link.bus

    def variables(self) -> list[Variable]:
        """All there are, with units."""
        return list(self._known.values())

    def read(self, path: str) -> Value:
        """Its value now: of a message the next one, so that what was done before is in it. What has
        labels is its label. UsageError for a path that is none, BenchFailure where nothing comes.
        """
        variable = named(self._known, path)
        if variable.index >= 0:
            return self._read_parameter(variable)
        if variable.keys:
            return self._read_rig(variable)
        seen: list[Value] = []
        self._listen(
            lambda name, _, value: seen.append(value) if name == path else None,
            lambda: bool(seen),
            READ_S,
        )
        if not seen:
            raise BenchFailure(f"{path}: nothing came in {READ_S:g} s; {no_answer(self._link)}")
        return seen[0]

    def write(self, path: str, value: Value) -> None:
        """In effect when it returns. UsageError for a value that is not allowed, BenchFailure where
        the controller refuses it or does not answer."""
        variable = named(self._known, path)
        if not variable.is_writable:
            raise UsageError(f"{path} can be read, not written")
        if variable.index >= 0:
            name = parameters()[variable.index]["name"]
            apply(self._services, settings_of([f"{name}={value}"]))
        else:
            self._ordered(**{variable.keys[0]: value})

    def stimulus(self, kind: str, drive_V: float | None = None, **keys: Any) -> None:
        """Shakes it from now on: a segment of a scenario, such as stimulus("sine", freq_Hz=12)."""
        drive = {} if drive_V is None else {"drive_V": drive_V}
        self._ordered(excite={"kind": kind, **keys}, **drive)

    def fault(self, kind: str, duration_s: float, of: str = "") -> None:
        """A fault of a scenario, from now on. of: a sensor or damper of its board."""
        self._ordered(fault={"kind": kind, "duration_s": duration_s, **({"of": of} if of else {})})

    def clear_faults(self) -> None:
        """Ends those that were injected; what the controller latched stays."""
        self._ordered(clear_faults=True)

    def turn_over(self, gravity_g: float) -> None:
        """Every accelerometer reads so much of gravity along its axis from now on, -1 .. 1; at
        first 0."""
        self._ordered(gravity_g=gravity_g)

    def stream_raw(self, length_s: int) -> None:
        """raw_sample/.. comes each tick for so long. BenchFailure where the controller does not do
        it."""
        reply = self._services.ask("RAW_STREAM", value=length_s)
        if reply is None or reply.result != DONE:
            why = no_answer(self._link) if reply is None else reply.result
            raise BenchFailure(f"every sample: {why}")

    def tables(self) -> Tables:
        """Of the controller. What comes while they are asked is no variable's."""
        return Tables(self._link, self._database)

    def send(self, frame_id: int, data: bytes) -> bool:
        """A frame of somebody else who is on this bus. Whether the bus took it."""
        return self._link.send(frame_id, data) is not None

    def emergency_stop(self, timeout_s: float) -> bool:
        """EmergencyStop until the controller reports fault ESTOP. Whether it did, in time."""
        while self._link.receive_now() is not None:
            pass  # what came before the press confirms nothing
        return press(self._link, self._database, timeout_s) is not None

    def wait(self, trigger: Trigger, timeout_s: float = 10.0) -> None:
        """Until it is so, or is so already. BenchFailure where it is not in time."""
        self._require_signals([trigger.path])
        met: list[bool] = []
        self._listen(
            lambda path, _, value: (
                met.append(True) if path == trigger.path and trigger.is_met(value) else None
            ),
            lambda: bool(met),
            timeout_s,
        )
        if not met:
            raise BenchFailure(f"{trigger} did not come about in {timeout_s:g} s")

    def capture(
        self,
        paths: Sequence[str],
        length_s: float,
        trigger: Trigger | None = None,
        pre_s: float = 0.0,
        timeout_s: float = 10.0,
        act: Callable[[], None] | None = None,
    ) -> dict[str, Series]:
        """Every sample of these signals, from pre_s before the trigger (without one: from now on)
        until length_s after it; a trigger within pre_s from now is none. BenchFailure where none
        comes in time. act: a write or a stimulus, done while it listens."""
        self._require_signals([*paths, *([trigger.path] if trigger else [])])
        if not (0.0 < length_s <= MOST_S and 0.0 <= pre_s <= MOST_S):
            raise UsageError(f"a capture is of 0 .. {MOST_S:g} s, before the trigger and after it")
        capture = Capture(paths, trigger, time.time() + pre_s)
        if trigger is None:
            capture.start_s = time.time()
        else:
            self._listen_for_trigger(capture, pre_s, timeout_s, act)
            act = None
        assert capture.start_s is not None
        end_s = capture.start_s + length_s
        self._listen(capture.take, lambda: False, end_s - time.time(), act)
        return capture.series(pre_s, length_s)

    def _listen_for_trigger(
        self,
        capture: Capture,
        pre_s: float,
        timeout_s: float,
        act: Callable[[], None] | None,
    ) -> None:
        def is_over() -> bool:
            capture.forget(time.time() - pre_s - READ_S)
            return capture.start_s is not None

        self._listen(capture.take, is_over, timeout_s, act)
        if capture.start_s is None:
            raise BenchFailure(f"{capture.trigger} did not come about in {timeout_s:g} s")

    def _require_signals(self, paths: Sequence[str]) -> None:
        for path in paths:
            if named(self._known, path).frame_id < 0:
                raise UsageError(f"{path} is no signal of a message: read it")

    def _listen(
        self,
        on_value: Callable[[str, float, Value], None],
        is_over: Callable[[], bool],
        timeout_s: float,
        act: Callable[[], None] | None = None,
    ) -> None:
        """To what comes from now on, also while `act` is done, which must not listen itself."""
        self._services.wait(0.0)
        while (event := self._link.receive_now()) is not None:
            self._services.take(event)
        self._on_value = on_value
        try:
            end_s = time.monotonic() + timeout_s
            if act is not None:
                act()
            while not is_over() and (left_s := end_s - time.monotonic()) > 0.0:
                event = self._link.receive(min(left_s, LOOK_S))
                if event is not None:
                    self._services.take(event)
        finally:
            self._on_value = None

    def _take(self, event: Any) -> None:
        """A frame, or the loss or return of the bus."""
        if not hasattr(event, "arbitration_id"):
            return
        is_trusted = self._traffic.take(event) in (OK, JUMPED)
        variables = self._by_frame.get(event.arbitration_id)
        if self._on_value is None or variables is None or not is_trusted:
            return
        values = self._database.decode(event.arbitration_id, bytes(event.data))
        for one in variables:
            if one.signal in values:
                self._on_value(one.path, event.timestamp, plain(values[one.signal]))

    def _read_parameter(self, variable: Variable) -> Value:
        reply = self._services.ask("READ", variable.index)
        if reply is None or reply.result != DONE:
            why = no_answer(self._link) if reply is None else reply.result
            raise BenchFailure(f"{variable.path}: {why}")
        known = parameters()[variable.index]
        return text_of(known, reply.param_value) if known["labels"] else reply.param_value

    def _read_rig(self, variable: Variable) -> Value:
        assert self._simulation is not None
        found: Any = self._simulation.next_state()
        for key in variable.keys:
            if found is None:
                break
            found = found[key]
        if found is None:
            raise BenchFailure(f"{variable.path}: not measured yet, a whole window has to pass")
        return found

    def _ordered(self, **what: Any) -> None:
        if self._simulation is None:
            raise UsageError("a controller on a bus: only a rig in the computer can be ordered")
        self._simulation.order(**what)


def plain(value: Any) -> Value:
    """A label as text, a number as it is."""
    return value if isinstance(value, int | float) else str(value)
