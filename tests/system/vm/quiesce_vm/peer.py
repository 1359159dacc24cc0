"""The host at the other end of the guest's CAN interface: sensor node, operator, and listener that
decodes everything with the shipped DBC. Paced by the controller's own frames, never by a clock."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.can.database import Database, load
from quiesce.can.e2e import ALIVE_PERIOD, JUMPED, OK, alive_of, protect
from quiesce.can.traffic import Traffic

from quiesce_vm.limits import HANG_S
from quiesce_vm.serial_line import SerialLine

END_ID = 0x7F0  # ends a step of the guest's script
OF_TABLES = "TableFlow"  # the fourth boot has it
ECHO_ID = 0x100  # comes back under the next id
CREDIT = 8  # frames under way at the most
LET_GO_COMMANDS = 4  # the third is the first that counts; then the edge arms
COMMAND_EVERY = 50  # demand frames of 2 ms: its cycle, as what comes faster counts for nothing
ATTEMPTS, ATTEMPT_FRAMES = 5, 1000  # of a request; demand frames until it is repeated
MOST_FRAMES = 50_000  # of the controller, until a condition must have come true


class Peer:
    """path: the Unix socket of the guest's serial line."""

    def __init__(self, path: Path) -> None:
        self.database: Database = load()
        self._line = SerialLine(path)
        self.traffic = Traffic(self.database)
        self.refused: list[str] = []  # frames that the DBC cannot explain
        self.freeze: dict[int, dict[str, Any]] = {}  # pages of the freeze frame, as they came last
        self._fault_resets = 0  # commands that still have it
        self._let_go = LET_GO_COMMANDS
        self._alive: dict[str, int] = {}
        self.demands = 0  # demand frames that came

    def close(self) -> None:
        self._line.close()

    @property
    def malformed(self) -> int:
        """Lines that were no frames."""
        return self._line.malformed

    def send(self, frame_id: int, data: bytes = b"") -> None:
        self._line.send(frame_id, data)

    def listen_to_the_end(self) -> None:
        """Takes what still comes: a guest whose line is full stands still."""
        while self._line.receive(HANG_S) is not None:
            pass

    def send_message(self, name: str, **signals: int) -> int:
        """Encodes and protects a message. Returns its alive counter."""
        message = self.database.by_name[name]
        assert message.protection is not None
        alive = self._alive.get(name, 0)
        self._alive[name] = (alive + 1) % ALIVE_PERIOD
        data = protect(message.protection, alive, self.database.encode(name, **signals))
        self.send(message.frame_id, data)
        return alive

    def echo(self, frames: int) -> int:
        """Sends frames that the guest sends back, CREDIT ahead at the most. Returns how many did
        not come, or came changed or out of their order."""
        sent = wrong = 0
        for number in range(frames):
            while sent < min(frames, number + CREDIT):
                self.send(ECHO_ID, sent.to_bytes(4, "little") + b"\x5a\xa5\x00\xff")
                sent += 1
            frame = self._line.receive(HANG_S)
            if frame is None:
                return wrong + frames - number
            expected = number.to_bytes(4, "little") + b"\x5a\xa5\x00\xff"
            wrong += (frame.arbitration_id, bytes(frame.data)) != (ECHO_ID + 1, expected)
        return wrong

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Plays its parts until the condition holds. BenchFailure where it never does."""
        for _ in range(MOST_FRAMES):
            if condition():
                return
            self.step()
        raise BenchFailure(f"the controller in the guest never came to this: {what}; {self.seen()}")

    def step(self) -> Any:
        """Takes one frame, answers it as its parts demand, returns it."""
        frame = self._line.receive(HANG_S)
        if frame is None:
            raise BenchFailure(f"the guest's bus is silent for {HANG_S:.0f} s; {self.seen()}")
        verdict = self.traffic.take(frame)
        if verdict in (OK, JUMPED):
            self._decode(frame)
        else:
            self.refused.append(f"{frame.arbitration_id:03X}: {verdict}")
        if frame.arbitration_id == self.database.by_name["CurrentDemand"].frame_id:
            self._answer_demand()
        return frame

    def values(self, name: str) -> dict[str, Any]:
        return self.traffic.values(name)

    def is_running(self) -> bool:
        """The law's current is on the bus."""
        demand = self.values("CurrentDemand")
        return str(demand.get("state")) == "RUN" and demand["driver_is_enabled"] == 1

    def acknowledge(self) -> None:
        """The operator's next two commands acknowledge a fault."""
        self._fault_resets = 2

    def request(self, operation: str, index: int = 0, value: int = 0) -> dict[str, Any]:
        """A service request; what the controller replied. BenchFailure where it never does."""
        number = self.database.number("ServiceRequest", "operation", operation)
        reply = self.database.by_name["ServiceReply"]
        assert reply.protection is not None
        attempts = 0
        while True:
            alive = self.send_message(
                "ServiceRequest", operation=number, param_index=index, param_value=value
            )
            last = self.demands + ATTEMPT_FRAMES
            while self.demands < last:
                frame = self.step()
                if (
                    frame.arbitration_id == reply.frame_id
                    and alive_of(reply.protection, bytes(frame.data)) == alive
                ):
                    return self.database.decode(reply.frame_id, bytes(frame.data))
            attempts += 1
            if attempts == ATTEMPTS:
                raise BenchFailure(f"the controller never answered {operation}; {self.seen()}")

    def expected(self) -> list[str]:
        """Messages of the controller: it has one damper, number 0, and a law without a table."""
        sent = [m for m in self.database.messages if m.sender == "Controller" and m.number == 0]
        return [m.name for m in sent if m.name != OF_TABLES]

    def missing(self) -> list[str]:
        """Those that have not come yet."""
        return [name for name in self.expected() if self.traffic.of(name) is None]

    def seen(self) -> str:
        counts = {one.message.name: one.count for one in self.traffic.seen.values()}
        return f"seen so far: {counts or 'nothing'}"

    def _decode(self, frame: Any) -> None:
        try:
            signals = self.database.decode(frame.arbitration_id, bytes(frame.data))
            if "freeze_number" in signals:
                self.freeze[int(signals["page"])] = signals
        except Exception as error:  # cantools has no common class
            self.refused.append(f"{frame.arbitration_id:03X} {frame.data.hex()}: {error}")

    def _answer_demand(self) -> None:
        self.demands += 1
        self.send_message("AccelSample", accel_counts=_counts(self.demands))
        if str(self.values("CurrentDemand").get("state")) in ("INIT", "SELF_TEST", "FAULT"):
            self._let_go = LET_GO_COMMANDS
        if self.demands % COMMAND_EVERY == 0:
            is_pressed = self._fault_resets > 0
            enable = int(self._let_go == 0)  # its edge arms
            self.send_message("OperatorCommand", enable=enable, fault_reset=int(is_pressed))
            self._fault_resets = max(0, self._fault_resets - 1)
            self._let_go = max(0, self._let_go - 1)


def _counts(number: int) -> int:
    """A triangle of 50 samples, with something on top that no two neighbours share."""
    phase = number % 50
    return (min(phase, 50 - phase) - 12) * 1200 + number * 37 % 101
