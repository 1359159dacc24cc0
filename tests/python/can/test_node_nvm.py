"""What the controller image keeps over a power-up, in a file that QEMU keeps the board's memory in.

A power cut is QEMU's end by SIGKILL at a chosen write to that memory, where its debugger's stub has
stopped it: what the image has written until then is in the file.
"""

import random
import socket
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from conftest import require
from test_node_image import DEADLINE_S, Rig, param_index, running

# hal/mps2/nvm_mps2.h, hal/records/nvm_records.h
MEMORY_BASE = 0x21000000
AREA_BASE = 0x21FE0000
SLOT_BYTES = 3 * 4096
MAGIC = 0x304D5651
HEAD_WORDS = 4
MOST_WORDS = 2048

PARAMS = 0
CURRENT = "constant_current_mA"


def slot_base(record: int, slot: int) -> int:
    return AREA_BASE + (2 * record + slot) * SLOT_BYTES


class Memory:
    """The board's memory as a file."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def options(self) -> tuple[str, ...]:
        """As docs/reference/targets.md has them."""
        backend = f"memory-backend-file,id=kept,share=on,size=16M,mem-path={self.path}"
        return ("-object", backend, "-M", "mps2-an386,memory-backend=kept")

    def words(self, address: int, count: int) -> tuple[int, ...]:
        with self.path.open("rb") as file:
            file.seek(address - MEMORY_BASE)
            return struct.unpack(f"<{count}I", file.read(4 * count))

    def flip(self, address: int) -> None:
        flipped = self.words(address, 1)[0] ^ 1
        with self.path.open("r+b") as file:
            file.seek(address - MEMORY_BASE)
            file.write(struct.pack("<I", flipped))

    def slot(self, record: int, slot: int) -> tuple[int, tuple[int, ...]] | None:
        """Number of the write and the record's words; None where the slot is not whole."""
        crc, sequence, count, magic = self.words(slot_base(record, slot), HEAD_WORDS)
        if magic != MAGIC + (record << 24) or count > MOST_WORDS:
            return None
        words = self.words(slot_base(record, slot) + 4 * HEAD_WORDS, count)
        covered = struct.pack(f"<{3 + count}I", sequence, count, magic, *words)
        return (sequence, words) if zlib.crc32(covered) == crc else None

    def spare(self, record: int) -> int:
        """The slot that is written next."""
        numbers = [(found[0] if (found := self.slot(record, slot)) else -1) for slot in range(2)]
        return numbers.index(min(numbers))


class Stub:
    """QEMU's stub for a debugger (the remote protocol of GDB): stops the board at a write."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def options(self) -> tuple[str, ...]:
        return ("-gdb", f"unix:{self.path},server=on,wait=off")

    @contextmanager
    def attached(self) -> Iterator["Stub"]:
        """The board stands still until until_written."""
        with socket.socket(socket.AF_UNIX) as self.line:
            self.line.settimeout(DEADLINE_S)
            self.line.connect(str(self.path))
            yield self

    def tell(self, text: str, answer: str) -> None:
        """Passes over packets until the one that begins so."""
        self.line.sendall(f"+${text}#{sum(text.encode()) % 256:02x}".encode())
        while not self.packet().startswith(answer):
            pass

    def packet(self) -> str:
        text = b""
        while not (b"$" in text and text[-3:-2] == b"#"):
            byte = self.line.recv(1)
            assert byte, "QEMU has ended"
            text += byte
        return text[text.index(b"$") + 1 : -3].decode()

    def until_written(self, address: int, times: int) -> None:
        """The board runs until the word has just been written that often: it stops before a
        write, which a step then does."""
        for _ in range(times):
            self.tell(f"Z2,{address:x},4", "OK")
            self.tell("c", "T05")
            self.tell(f"z2,{address:x},4", "OK")
            self.tell("s", "T05")


@pytest.fixture
def image(build: Path) -> Path:
    return require(build / "mps2/targets/mps2/quiesce_mps2_node.elf")


@pytest.fixture
def memory(tmp_path: Path) -> Memory:
    return Memory(tmp_path / "memory")


def stage(rig: Rig, current_mA: int) -> None:
    assert rig.ask("STAGE", param_index(CURRENT), current_mA)["result"] == "DONE"
    assert rig.ask("APPLY")["result"] == "DONE"


def current_of(rig: Rig) -> int:
    return rig.ask("READ", param_index(CURRENT))["param_value"]


def settle(rig: Rig) -> None:
    """Until no request is under way: none was asked twice."""
    asked = -1
    while rig.alive.get("ServiceRequest", 0) != asked + 1:
        asked = rig.alive.get("ServiceRequest", 0)
        rig.ask("READ")


def test_saved_parameters_are_used_after_a_power_up(image: Path, memory: Memory) -> None:
    with running(image, memory.options()) as rig:
        shipped = current_of(rig)
        stage(rig, 1234)
        assert rig.ask("SAVE")["result"] == "DONE"
        stage(rig, 777)  # not saved
    with running(image, memory.options()) as rig:
        assert current_of(rig) == 1234
    # Both slots damaged: what ships is used, and others can be saved.
    for slot in range(2):
        memory.flip(slot_base(PARAMS, slot) + 40)
    with running(image, memory.options()) as rig:
        assert current_of(rig) == shipped
        stage(rig, 555)
        assert rig.ask("SAVE")["result"] == "DONE"
    with running(image, memory.options()) as rig:
        assert current_of(rig) == 555


# Word of the slot, and the write to it: the first one erases, the second one programs.
ANY = random.Random(20)
MOMENTS = [
    *[(word, 1) for word in (0, 3, ANY.randrange(4, 1024))],
    *[(word, 2) for word in (4, ANY.randrange(5, 50), 0, 2, 3)],
]


def test_power_cut_while_parameters_are_saved(
    image: Path, memory: Memory, tmp_path: Path
) -> None:
    stub = Stub(tmp_path / "stub")
    with running(image, memory.options()) as rig:
        kept = 900
        stage(rig, kept)
        assert rig.ask("SAVE")["result"] == "DONE"
    outcomes = set()
    for i, (word, times) in enumerate(MOMENTS):
        with running(image, memory.options() + stub.options()) as rig:
            assert current_of(rig) == kept
            stage(rig, 1000 + i)
            settle(rig)
            with stub.attached():
                rig.send("ServiceRequest", operation="SAVE")
                stub.until_written(slot_base(PARAMS, memory.spare(PARAMS)) + 4 * word, times)
                rig.cut_power()
        whole = [found for slot in range(2) if (found := memory.slot(PARAMS, slot))]
        newest = max(whole)[1]
        outcomes.add(newest[1 + param_index(CURRENT)] == kept)
        kept = newest[1 + param_index(CURRENT)]
    with running(image, memory.options()) as rig:
        assert current_of(rig) == kept
    assert outcomes == {False, True}
