"""The four boots of the virtual machine, and what each of them brings back.

Nothing here judges a figure: tests and `measure` do. BenchFailure where a boot does not come to its
end.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, one_line
from quiesce.base.paths import build_folder, root
from quiesce.engine.bench import require_file

from quiesce_vm.initramfs import Parts, build
from quiesce_vm.limits import HANG_S
from quiesce_vm.line_pty import LinePty
from quiesce_vm.machine import Boot, Machine
from quiesce_vm.peer import END_ID, Peer
from quiesce_vm.qmp import Qtest
from quiesce_vm.results import results_of

ECHOES = 10_000  # as in tests/system/vm/guest/bus.sh
# Lines of the machine's GPIO chip, as in tests/system/vm/guest/bus.sh
ENABLE_LINE, FAULT_LINE, ESTOP_LINE = 1, 2, 5
LOCKSTEP_SEED = 1
RAW_STREAM_S = 1
RECORD_DEMANDS = 1000  # until a record of a fault is whole, with room to spare
RECORD_FROM_PAGE = 316  # of 318
FREEZE_PAGES = 6
ACKNOWLEDGE_EVERY = 250  # demand frames, five commands

Results = dict[str, dict[str, Any]]


class Vm:
    """What the boots share: one memory file system, in a folder of its own while it is open."""

    def __init__(self, parts: Parts, folder: Path) -> None:
        self.parts = parts
        self.initramfs = build(parts, folder / "initramfs.cpio")
        self.serial_line = folder / "line"

    def boot(self, script: str, serial_line: Path | None = None) -> Machine:
        return Machine(Boot(self.parts.vmlinuz, self.initramfs, script, serial_line))


@contextmanager
def opened(parts: Parts | None = None) -> Iterator[Vm]:
    """UsageError where tests/system/vm/build_images has not run."""
    with tempfile.TemporaryDirectory(prefix="quiesce-vm-") as folder:
        yield Vm(parts or Parts.built(), Path(folder))


@dataclass(frozen=True)
class Estop:
    """What the bus and the lines did around an emergency stop from outside."""

    status: dict[str, Any]
    demand: dict[str, Any]
    freeze_fault: str


@dataclass(frozen=True)
class BusRun:
    """Lock-step, echo and control over the guest's slcan0."""

    results: Results
    lockstep: dict[str, Any]  # the bench's comparison
    echo_wrong: int
    replies: dict[str, dict[str, Any]]  # to each service request
    estop: Estop
    missing: list[str]  # messages of the controller that never came
    counts: dict[str, int]  # frames that came, by message
    refused: list[str]  # frames that the DBC or their protection cannot explain
    malformed: int


def run_bus(vm: Vm) -> BusRun:
    with vm.boot("bus.sh", vm.serial_line) as machine:
        gpio = machine.gpio()  # sees changes from now on
        machine.wait_line("LOCKSTEP-READY")
        lockstep = compare(vm.serial_line)
        peer = Peer(vm.serial_line)
        try:
            return _drive(machine, gpio, peer, lockstep)
        except BenchFailure as error:
            raise BenchFailure(f"{error}; {machine.tail()}")
        finally:
            peer.close()


def compare(line: Path) -> dict[str, Any]:
    """The bench's lock-step comparison of the guest's controller with the host's."""
    bench = require_file(build_folder() / "host/sim_hil/quiesce_bench", "the bench")
    command = [str(bench), "compare", "--seeds", str(LOCKSTEP_SEED)]
    command += ["--scenario", str(root() / "tests/system/vm/lockstep.toml"), "--law", "phase"]
    command += ["--target", "linux", "--can", f"slcan:unix:{line}"]
    command += ["--telemetry-every", "10"]
    try:
        result = subprocess.run(command, capture_output=True, text=True, timeout=HANG_S)
    except subprocess.TimeoutExpired:
        raise BenchFailure(f"quiesce_bench compare: not done after {HANG_S:.0f} s")
    if result.returncode != 0:
        raise BenchFailure(f"quiesce_bench compare: {one_line(result.stderr)}")
    return json.loads(result.stdout)


def _drive(machine: Machine, gpio: Qtest, peer: Peer, lockstep: dict[str, Any]) -> BusRun:
    peer.send(END_ID)
    machine.wait_line("ECHO-READY")
    echo_wrong = peer.echo(ECHOES)
    machine.wait_line('RESULT {"name": "after_echo"')
    peer.until(peer.is_running, "running")
    replies = _ask(peer)
    estop = _press(gpio, peer)
    _fetch_record(peer)
    peer.until(lambda: not peer.missing(), "every message of the controller")
    peer.send(END_ID)
    peer.listen_to_the_end()
    lines = machine.wait_end()
    return BusRun(
        results=results_of(lines),
        lockstep=lockstep,
        echo_wrong=echo_wrong,
        replies=replies,
        estop=estop,
        missing=peer.missing(),
        counts={one.message.name: one.count for one in peer.traffic.seen.values()},
        refused=peer.refused,
        malformed=peer.malformed,
    )


def _ask(peer: Peer) -> dict[str, dict[str, Any]]:
    return {
        "read": peer.request("READ", 0),
        "no_such_parameter": peer.request("READ", 255),
        "out_of_range": peer.request("STAGE", 0, 3),
        "raw_stream": peer.request("RAW_STREAM", 0, RAW_STREAM_S),
    }


def _fetch_record(peer: Peer) -> None:
    """Asks for the last pages of the fault's record, once it is whole."""
    whole = peer.demands + RECORD_DEMANDS
    peer.until(lambda: peer.demands >= whole, "a record that is whole")
    peer.request("FAULT_RECORD", 0, RECORD_FROM_PAGE)


def _press(gpio: Qtest, peer: Peer) -> Estop:
    """Presses, looks, releases, acknowledges, until the controller runs again."""
    peer.until(lambda: gpio.output(ENABLE_LINE) is True, "the enable line is on")
    gpio.set_input(ESTOP_LINE, True)
    peer.until(lambda: str(peer.values("Status").get("fault")) == "ESTOP", "fault ESTOP")
    peer.until(lambda: gpio.output(FAULT_LINE) is True, "the fault line is on")
    peer.until(lambda: gpio.output(ENABLE_LINE) is False, "the enable line is off")
    status, demand = peer.values("Status"), peer.values("CurrentDemand")
    fault = _freeze_fault(peer)
    gpio.set_input(ESTOP_LINE, False)
    peer.until(lambda: peer.values("Status").get("is_estop") == 0, "released")
    _acknowledge(peer)
    return Estop(status, demand, fault)


def _acknowledge(peer: Peer) -> None:
    """An acknowledgement counts from a command on that had come in time: again until it did."""

    def is_answered() -> bool:
        if peer.demands % ACKNOWLEDGE_EVERY == 0:
            peer.acknowledge()
        return peer.is_running()

    peer.until(is_answered, "running again after the acknowledgement")


def _freeze_fault(peer: Peer) -> str:
    """Asks for the freeze frame; the fault that it names, when all its pages have come."""
    peer.freeze.clear()
    reply = peer.request("FREEZE_FRAME")
    if str(reply["result"]) != "DONE":
        raise BenchFailure(f"the controller has no freeze frame of the stop: {reply}")
    peer.until(lambda: len(peer.freeze) == FREEZE_PAGES, "all pages of the freeze frame")
    return str(peer.freeze[0]["freeze_fault"])


@dataclass(frozen=True)
class TimingRun:
    """All of it virtual time; the console's result lines, word for word, for comparison."""

    results: Results
    edges_ns: list[int]  # the kernel's time stamps, as the controller logged them
    text: str


def run_timing(vm: Vm) -> TimingRun:
    with vm.boot("timing.sh") as machine:
        lines = machine.wait_end()
        try:
            results = results_of(lines)
        except BenchFailure as error:
            raise BenchFailure(f"{error}; {machine.tail()}")
    kept = [line for line in lines if line.startswith(("RESULT ", "LOG "))]
    edges = [line.split()[-2] for line in kept if "emergency stop: edge at" in line]
    return TimingRun(results, [int(edge) for edge in edges], "\n".join(kept))


@dataclass(frozen=True)
class FaultRun:
    results: Results
    ending: str  # how QEMU says that the machine stopped
    lines: list[str]


def run_faults(vm: Vm) -> FaultRun:
    with vm.boot("faults.sh") as machine:
        qmp = machine.qmp  # before the end: it tells how the machine stopped
        lines = machine.wait_end()
        try:
            return FaultRun(results_of(lines), qmp.ending(), lines)
        except BenchFailure as error:
            raise BenchFailure(f"{error}; {machine.tail()}")


@dataclass(frozen=True)
class TablesRun:
    """What `quiesce can` printed: `tables` of each controller, and what was loaded and fetched."""

    results: Results
    before: dict[str, Any]
    loaded: dict[str, Any]
    after: dict[str, Any]
    restarted: dict[str, Any]
    fetched: dict[str, Any]
    damaged: dict[str, Any]


def run_tables(vm: Vm) -> TablesRun:
    with vm.boot("tables.sh", vm.serial_line) as machine:
        machine.wait_line("READY loaded")
        line = LinePty(vm.serial_line)
        try:
            return _load(machine, line, vm.serial_line.parent)
        except BenchFailure as error:
            raise BenchFailure(f"{error}; {machine.tail()}")
        finally:
            line.close()


def _load(machine: Machine, line: LinePty, folder: Path) -> TablesRun:
    def can(*words: str) -> dict[str, Any]:
        with line.in_use() as name:
            return _can(name, *words)

    def end_step(next_ready: str) -> None:
        line.send(b"t%03X0" % END_ID)
        machine.wait_line(next_ready)

    before = can("tables")
    loaded = can("load", "pulses", str(_other_pulses(folder)), "--save")
    after = can("tables")
    end_step("READY restarted")
    restarted = can("tables")
    fetched = can("fetch", "law", "-o", str(folder / "fetched.table"))
    end_step("READY damaged")
    damaged = can("tables")
    end_step('RESULT {"name": "damaged"')
    results = results_of(machine.wait_end())
    return TablesRun(results, before, loaded, after, restarted, fetched, damaged)


def _other_pulses(folder: Path) -> Path:
    """Those that ship, but for a current."""
    shipped = root() / "firmware/plants/squeeze_2012/pulses.phase.toml"
    file = folder / "other.phase.toml"
    text = shipped.read_text()
    file.write_text(text.replace("\nunlock_current_mA = 5000", "\nunlock_current_mA = 4000"))
    return file


def _can(line: str, *words: str) -> dict[str, Any]:
    """A call of `quiesce can` on the bus behind the line."""
    command = [sys.executable, "-m", "quiesce", "can", *words, "--json", "--bus", f"slcan:{line}"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=HANG_S)
    if result.returncode != 0:
        raise BenchFailure(f"quiesce can {words[0]}: {one_line(result.stderr)}")
    return json.loads(result.stdout)
