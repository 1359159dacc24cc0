"""Sensor node and operator around a free-running controller image in QEMU, with python-can.

Nothing waits for a time: every demand frame of the image is answered with a sample, and each step
goes on when the bus shows what it waits for.
"""

import re
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import can
import pytest
from can_protection import encode, frame_crc, is_protected, load_database

DATABASE = load_database()
DEADLINE_S = 60.0
COMMAND_EVERY_DEMANDS = 100
FAULT_ID = 0x7F0  # tests/unit/mps2/fault_on_frame.c
MOST_RESTARTS = 3  # hal/cortex_m/fault.h
ASK_AGAIN_AFTER_DEMANDS = 500  # a reply may be lost where this machine reads too slowly
# A constant current that the demand shows; a sensor on a busy machine is late now and then.
PARAMETERS = {
    "law": 1,
    "constant_current_mA": 1234,
    "sensor_max_age_ticks": 1000,
    "sensor_recover_ticks": 1,
}
# The image has one damper, and its processor no counter of cycles.
NOT_SENT = ("CurrentDemand1", "CurrentDemand2", "CurrentDemand3", "LoopCycles")
CONTROLLER = {
    m.frame_id for m in DATABASE.messages if "Controller" in m.senders and m.name not in NOT_SENT
}


# Let go, then pressed for longer, in whole commands: they come ten times a second, statuses a
# hundred times, and a command counts once its counter and its time have fitted.
LET_GO_COMMANDS, PRESSED_COMMANDS = 4, 12
MOST_PRESSES = 6


class Rig:
    """Sensor node and operator around the controller on a bus."""

    def __init__(self, bus: can.BusABC, cut_power: Callable[[], None]) -> None:
        self.bus = bus
        self.cut_power = cut_power
        self.alive: dict[str, int] = {}
        self.demands = 0
        self.command_due = 0
        self.seen: dict[str, dict] = {}
        self.pages: dict[int, dict] = {}
        self.last_alive: dict[int, int] = {}
        self.enable = 0
        self.is_acknowledging = False
        self.is_stopping = False
        self.noise = 1

    def send(self, name: str, **values: int | str) -> None:
        message = DATABASE.get_message_by_name(name)
        alive = self.alive.get(name, 0)
        self.alive[name] = alive + 1
        data = encode(message, alive, **values)
        self.bus.send(can.Message(arbitration_id=message.frame_id, data=data, is_extended_id=False))

    def send_sample(self) -> None:
        self.noise = self.noise * 1664525 + 1013904223 & 0xFFFFFFFF
        self.send("AccelSample", accel_counts=(self.noise >> 16) - 32768)

    def on_demand(self, alive: int) -> None:
        """The demand's counter is the controller's clock, lost frames included."""
        self.demands += (alive - self.demands - 1) % 16 + 1
        self.send_sample()
        if self.demands >= self.command_due:
            self.command_due = max(self.command_due, self.demands - COMMAND_EVERY_DEMANDS)
            self.command_due += COMMAND_EVERY_DEMANDS
            # Pressed and released in turn: two frames that press count, after one that does not.
            is_pressed = self.is_acknowledging and self.alive.get("OperatorCommand", 0) // 2 % 2
            self.send("OperatorCommand", enable=self.enable, fault_reset=int(is_pressed))
            if self.is_stopping:
                self.send("EmergencyStop", code="STOP")

    def take(self, frame: can.Message) -> str:
        """Checks and keeps a frame; returns its name."""
        assert frame.arbitration_id in CONTROLLER and not frame.is_extended_id
        message = DATABASE.get_message_by_frame_id(frame.arbitration_id)
        assert len(frame.data) == message.length, message.name
        if is_protected(message):
            assert frame.data[-1] == frame_crc(frame.arbitration_id, bytes(frame.data))
        values = message.decode(bytes(frame.data))
        self.seen[message.name] = values
        if message.name == "FaultFreeze":
            self.pages[values["page"]] = values
        if message.name == "CurrentDemand":
            self.on_demand(values["alive"])
        return message.name

    def receive(self) -> can.Message | None:
        try:
            return self.bus.recv(timeout=1.0)
        except (IndexError, ValueError):  # a line that a fault of the processor has cut off
            return None

    def until(self, what: str, holds: Callable[[str], bool]) -> None:
        """Runs the bus until holds(name of the frame that has come)."""
        silent = 0
        for _ in range(2_000_000):
            frame = self.receive()
            if frame is None:
                silent += 1
                assert silent < DEADLINE_S, f"silence while waiting for {what}"
                continue
            silent = 0
            if holds(self.take(frame)):
                return
        pytest.fail(f"never saw {what}: {self.seen}")

    def until_state(self, state: str) -> None:
        self.until(state, lambda name: name == "Status" and self.seen[name]["state"] == state)

    def run(self) -> None:
        """Lets go, and enables where that counts, by turns: what is held when the controller starts
        anew, or a late frame has undone, arms nothing."""
        self.enable = 0
        first = self.alive.get("OperatorCommand", 0)
        presses = 0

        def runs(name: str) -> bool:
            nonlocal presses
            if name != "Status":
                return False
            state = self.seen["Status"]["state"]
            if state == "IDLE":
                sent = self.alive.get("OperatorCommand", 0) - first
                pressed = int(sent % (LET_GO_COMMANDS + PRESSED_COMMANDS) >= LET_GO_COMMANDS)
                presses += int(pressed > self.enable)
                assert presses <= MOST_PRESSES, "enabled in vain"
                self.enable = pressed
            return state == "RUN" and self.enable == 1

        self.until("RUN", runs)

    def ask(self, operation: str, index: int = 0, value: int = 0) -> dict:
        """The reply; asked again until there is one. Each operation may be done twice."""
        request = {"operation": operation, "param_index": index, "param_value": value}
        asked: dict[int, int] = {}  # alive counter: demands when it was sent

        def ask_once() -> None:
            asked[self.alive.get("ServiceRequest", 0) % 16] = self.demands
            self.send("ServiceRequest", **request)

        def is_answered(name: str) -> bool:
            if name == "ServiceReply":
                reply = self.seen[name]
                return reply["alive"] in asked and reply["result"] != "BUSY"
            if self.demands - max(asked.values()) > ASK_AGAIN_AFTER_DEMANDS:
                ask_once()
            return False

        ask_once()
        self.until(f"reply to {operation}", is_answered)
        return self.seen["ServiceReply"]

    def has_freeze_frame(self, fault: str) -> bool:
        """All pages are here, of one freeze frame, and it is of that fault."""
        numbers = {page["freeze_number"] for page in self.pages.values()}
        is_whole = len(self.pages) == 6 and len(numbers) == 1
        return is_whole and self.pages[0]["freeze_fault"] == fault


def close(bus: can.BusABC) -> None:
    """It says goodbye first, which fails where the power was cut."""
    try:
        bus.shutdown()
    except can.CanError:
        bus.serialPortOrig.close()


@contextmanager
def running(image: Path, options: tuple[str, ...] = ("-M", "mps2-an386")) -> Iterator[Rig]:
    """The image in the emulator, and a bus to it. options: QEMU's, the machine's among them."""
    # An instruction takes 2 ns of the board's time, which then is slow: a machine under load loses
    # no tick, and its samples come within the 4 ms that a sensor may be off.
    qemu = subprocess.Popen(
        ["qemu-system-arm", *options, "-display", "none", "-monitor", "none"]
        + ["-icount", "shift=1,sleep=off", "-serial", "pty", "-kernel", str(image)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        line = qemu.stdout.readline()
        found = re.search(r"redirected to (\S+)", line)
        assert found, line
        bus = can.Bus(interface="slcan", channel=found[1], bitrate=500_000, sleep_after_open=0)
        try:
            yield Rig(bus, qemu.kill)
        finally:
            close(bus)
    finally:
        qemu.kill()
        qemu.wait()
        qemu.stdout.close()


def param_index(name: str) -> int:
    header = (Path(__file__).resolve().parents[3] / "firmware/include/quiesce_params.h").read_text()
    fields = re.findall(r"^    int32_t (\w+); ///<", header, re.MULTILINE)
    return fields.index(name)


def cause_fault(rig: Rig) -> None:
    rig.bus.send(can.Message(arbitration_id=FAULT_ID, is_extended_id=False))


def arm(rig: Rig) -> None:
    """With parameters that a sensor on a busy machine is good enough for."""
    for name, value in PARAMETERS.items():
        assert rig.ask("STAGE", param_index(name), value)["result"] == "DONE", name
    assert rig.ask("APPLY")["result"] == "DONE"
    rig.run()


def is_first(name: str, demand: dict) -> bool:
    return name == "CurrentDemand" and demand["alive"] == 0 and demand["driver_is_enabled"] == 0
