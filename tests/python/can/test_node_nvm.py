"""What the controller image keeps over a power-up, in a file that QEMU keeps the board's memory in.

A power cut is QEMU's end by SIGKILL at a chosen write to that memory, where its debugger's stub has
stopped it: what the image has written until then is in the file.
"""

import random
import socket
import struct
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from conftest import ROOT, require
from quiesce.tune.phase_table import read_law
from quiesce.tune.phase_words import law_words
from test_node_image import DEADLINE_S, Rig, param_index, running

# hal/mps2/nvm_mps2.h, hal/records/nvm_records.h
MEMORY_BASE = 0x21000000
AREA_BASE = 0x21FE0000
SLOT_BYTES = 3 * 4096
MAGIC = 0x304D5651
HEAD_WORDS = 4
MOST_WORDS = 2048
NO_BOARD = 0  # the memory's owner

PARAMS, LAW_TABLE, TRACKER_TABLE, LEARNT_RECORD = 0, 1, 2, 3  # records
LAW, TRACKER, LEARNT = 0, 1, 2  # roads
INFO_CRC, INFO_STORED_CRC, INFO_SOURCE, INFO_WRITES, INFO_RECORD = 0, 2, 3, 5, 7
SHIPS, FROM_STORE = 1, 3
WHOLE, OLDER = 0, 1  # how a record was found
PHASE, LINEAR = 4, 5  # laws
CURRENT = "constant_current_mA"
TRIM_WORD = 7  # of a record of what was learnt, after its own head and that of the law's words


def slot_base(record: int, slot: int) -> int:
    return AREA_BASE + (2 * record + slot) * SLOT_BYTES


def crc_of(head: Sequence[int], words: Sequence[int]) -> int:
    covered = (NO_BOARD, *head, *words)
    return zlib.crc32(struct.pack(f"<{len(covered)}I", *covered))


def pulses(unlock_current_mA: int) -> tuple[int, ...]:
    """A table of the law `phase`: what ships, but for a current."""
    law = read_law(ROOT / "firmware/plants/squeeze_2012/pulses.phase.toml")
    return tuple(law_words(replace(law, unlock_current_mA=unlock_current_mA)))


def table(words: Sequence[int]) -> tuple[int, ...]:
    """The same with its own count and CRC."""
    after = [len(words), *(word % 2**32 for word in words[3:])]
    return (words[0], zlib.crc32(struct.pack(f"<{len(after)}I", *after)), *after)


def damper_map(force_mN: int) -> tuple[int, ...]:
    """Forces over stroke velocity, 2 places, and current, 2 of them."""
    velocities, currents = (-1000, 1000), (0, 1500)
    forces = (-20_000, -force_mN, 20_000, force_mN)
    return table([0x32464D51, 0, 0, 1, 4, 2, 2, *velocities, *currents, *forces])


def with_trim(learnt: Sequence[int], trim: int) -> tuple[int, ...]:
    """What was learnt, with another trim of its first point; words 3 and 4 are the law's own magic
    and CRC."""
    words = [*learnt]
    words[TRIM_WORD] = words[TRIM_WORD] & 0xFFFF0000 | trim
    words[4] = zlib.crc32(struct.pack(f"<{len(words) - 5}I", *words[5:]))
    return table(words)


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

    def write(self, address: int, words: Sequence[int]) -> None:
        with self.path.open("r+b") as file:
            file.seek(address - MEMORY_BASE)
            file.write(struct.pack(f"<{len(words)}I", *words))

    def flip(self, address: int) -> None:
        self.write(address, [self.words(address, 1)[0] ^ 1])

    def put(self, record: int, words: Sequence[int]) -> None:
        """In place of what a start finds, or as the first write."""
        sequence, _ = self.kept(record) or (1, ())
        head = (sequence, len(words), MAGIC + (record << 24))
        self.write(self.newest(record), (crc_of(head, words), *head, *words))

    def slot(self, record: int, slot: int) -> tuple[int, tuple[int, ...]] | None:
        """Number of the write and the record's words; None where the slot is not whole."""
        crc, sequence, count, magic = self.words(slot_base(record, slot), HEAD_WORDS)
        if magic != MAGIC + (record << 24) or count > MOST_WORDS:
            return None
        words = self.words(slot_base(record, slot) + 4 * HEAD_WORDS, count)
        is_whole = crc == crc_of((sequence, count, magic), words)
        return (sequence, words) if is_whole else None

    def kept(self, record: int) -> tuple[int, tuple[int, ...]] | None:
        """What a start finds."""
        return max((one for slot in (0, 1) if (one := self.slot(record, slot))), default=None)

    def newest(self, record: int) -> int:
        """Where its slot begins; the first write goes to slot 1."""
        kept = self.kept(record)
        return slot_base(record, int(kept is None or self.slot(record, 1) == kept))

    def spare(self, record: int) -> int:
        """The other slot."""
        return 2 * slot_base(record, 0) + SLOT_BYTES - self.newest(record)


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


def save_with(rig: Rig, name: str, value: int) -> None:
    assert rig.ask("STAGE", param_index(name), value)["result"] == "DONE"
    assert rig.ask("APPLY")["result"] == "DONE"
    assert rig.ask("SAVE")["result"] == "DONE"


def current_of(rig: Rig) -> int:
    return rig.ask("READ", param_index(CURRENT))["param_value"]


def info(rig: Rig, road: int, what: int) -> int:
    reply = rig.ask("TABLE_INFO", road, what)
    assert reply["result"] == "DONE"
    return reply["param_value"] & 0xFFFFFFFF


def test_saved_parameters_are_used_after_a_power_up(image: Path, memory: Memory) -> None:
    with running(image, memory.options()) as rig:
        shipped = current_of(rig)
        save_with(rig, CURRENT, 1234)
    with running(image, memory.options()) as rig:
        assert current_of(rig) == 1234
    # Both slots damaged: what ships is used, and others can be saved.
    for slot in range(2):
        memory.flip(slot_base(PARAMS, slot) + 40)
    with running(image, memory.options()) as rig:
        assert current_of(rig) == shipped
        save_with(rig, CURRENT, 555)
    with running(image, memory.options()) as rig:
        assert current_of(rig) == 555


@pytest.mark.slow
def test_saved_tables_are_used_after_a_power_up(image: Path, memory: Memory) -> None:
    with running(image, memory.options()) as rig:
        save_with(rig, "law", PHASE)
        shipped = info(rig, LAW, INFO_CRC)
    memory.put(LAW_TABLE, pulses(777))
    with running(image, memory.options()) as rig:
        assert info(rig, LAW, INFO_CRC) == info(rig, LAW, INFO_STORED_CRC) == pulses(777)[1]
        assert info(rig, LAW, INFO_SOURCE) == FROM_STORE and info(rig, LAW, INFO_WRITES) == 1
        assert rig.ask("TABLE_SAVE", LAW)["result"] == "DONE"
        assert rig.ask("TABLE_SAVE", LEARNT)["result"] == "DONE"
    with running(image, memory.options()) as rig:
        assert info(rig, LAW, INFO_CRC) == pulses(777)[1] and info(rig, LAW, INFO_WRITES) >= 2
        assert rig.ask("LEARNT_RESTORE")["result"] == "DONE"
        assert rig.ask("TABLE_SHIP", LAW)["result"] == "DONE"
        assert rig.ask("TABLE_SAVE", LAW)["result"] == "DONE"  # forgets it
    with running(image, memory.options()) as rig:
        assert info(rig, LAW, INFO_CRC) == shipped and info(rig, LAW, INFO_STORED_CRC) == 0
        assert info(rig, LAW, INFO_SOURCE) == SHIPS and info(rig, LAW, INFO_WRITES) >= 3
        assert rig.ask("LEARNT_RESTORE")["result"] == "TABLE_REFUSED"  # of the other table


@pytest.mark.slow
def test_older_record_is_told_until_it_is_stored_again(image: Path, memory: Memory) -> None:
    with running(image, memory.options()) as rig:
        save_with(rig, "law", PHASE)
    memory.put(LAW_TABLE, pulses(700))
    with running(image, memory.options()) as rig:
        assert info(rig, LAW, INFO_RECORD) == WHOLE
        memory.put(LAW_TABLE, pulses(701))  # behind its back: now the two slots differ
        assert rig.ask("TABLE_SAVE", LAW)["result"] == "DONE"
    memory.flip(memory.newest(LAW_TABLE) + 80)
    with running(image, memory.options()) as rig:
        assert info(rig, LAW, INFO_CRC) == pulses(701)[1]  # the one before
        assert info(rig, LAW, INFO_RECORD) == OLDER
        assert info(rig, TRACKER, INFO_RECORD) == WHOLE
        assert rig.ask("TABLE_SAVE", LAW)["result"] == "DONE"
        assert info(rig, LAW, INFO_RECORD) == WHOLE
    with running(image, memory.options()) as rig:
        assert info(rig, LAW, INFO_CRC) == pulses(701)[1]
        assert info(rig, LAW, INFO_RECORD) == WHOLE


@pytest.mark.slow
def test_stored_table_waits_for_the_law_that_it_is_of(image: Path, memory: Memory) -> None:
    """The law was applied, but not saved with its table."""
    with running(image, memory.options()) as rig:
        shipped = info(rig, LAW, INFO_CRC)
    memory.put(LAW_TABLE, pulses(777))
    with running(image, memory.options()) as rig:
        assert info(rig, LAW, INFO_CRC) == shipped
        assert rig.ask("STAGE", param_index("law"), PHASE)["result"] == "DONE"
        assert rig.ask("APPLY")["result"] == "DONE"
        assert info(rig, LAW, INFO_CRC) == pulses(777)[1]
        assert info(rig, LAW, INFO_SOURCE) == FROM_STORE


@dataclass(frozen=True)
class Subject:
    """A record, how it is asked for and saved, the word that tells it apart, and the law that has
    it."""

    record: int
    save: tuple[str, int]
    question: tuple[str, int]
    place: int
    law: int = PHASE


SUBJECTS = [
    Subject(PARAMS, ("SAVE", 0), ("READ", param_index(CURRENT)), 1 + param_index(CURRENT)),
    Subject(LAW_TABLE, ("TABLE_SAVE", LAW), ("TABLE_INFO", LAW), 1),
    Subject(TRACKER_TABLE, ("TABLE_SAVE", TRACKER), ("TABLE_INFO", TRACKER), 1, LINEAR),
    Subject(LEARNT_RECORD, ("TABLE_SAVE", LEARNT), ("TABLE_INFO", LEARNT), 1),
]


def two_of(memory: Memory, subject: Subject) -> list[tuple[int, ...]]:
    """Two good contents of its record; what is there by now is of the subject's law."""
    at = subject.place
    if subject.record == PARAMS:
        _, params = memory.kept(PARAMS)
        return [(*params[:at], 700 + i, *params[at + 1 :]) for i in range(2)]
    if subject.record == LEARNT_RECORD:
        _, learnt = memory.kept(LEARNT_RECORD)
        return [with_trim(learnt, 1 + i) for i in range(2)]
    if subject.record == TRACKER_TABLE:
        return [damper_map(400_000 + i) for i in range(2)]
    return [pulses(700 + i) for i in range(2)]


# Word of the slot, and the write to it: the first one erases, the second one programs.
ANY = random.Random(20)
MOMENTS = [
    *[(word, 1) for word in (0, 3, ANY.randrange(4, 1024))],
    *[(word, 2) for word in (4, ANY.randrange(5, 40), 0, 2, 3)],
]


def settled(rig: Rig, operation: str, index: int) -> int:
    """The answer, once no request is under way: none was asked twice."""
    while True:
        asked = rig.alive.get("ServiceRequest", 0)
        answer = rig.ask(operation, index)["param_value"]
        if rig.alive["ServiceRequest"] == asked + 1:
            return answer & 0xFFFFFFFF


@pytest.mark.slow
@pytest.mark.parametrize("subject", SUBJECTS, ids=("parameters", "law", "tracker", "learnt"))
def test_power_cut_leaves_the_old_or_the_new(
    image: Path, memory: Memory, tmp_path: Path, subject: Subject
) -> None:
    stub = Stub(tmp_path / "stub")
    with running(image, memory.options()) as rig:
        save_with(rig, "law", subject.law)
        if subject.record == LEARNT_RECORD:
            assert rig.ask("TABLE_SAVE", LEARNT)["result"] == "DONE"
    words = two_of(memory, subject)
    memory.put(subject.record, words[0])
    outcomes = set()
    for word, times in MOMENTS:
        with running(image, (*memory.options(), *stub.options())) as rig:
            _, used = memory.kept(subject.record)
            assert settled(rig, *subject.question) == used[subject.place]
            # Behind its back the record becomes the other one, which it replaces.
            memory.put(subject.record, words[1 - words.index(used)])
            with stub.attached():
                operation, road = subject.save
                rig.send("ServiceRequest", operation=operation, param_index=road)
                stub.until_written(memory.spare(subject.record) + 4 * word, times)
                rig.cut_power()
        _, found = memory.kept(subject.record)
        assert found in words
        outcomes.add(found == used)
    with running(image, memory.options()) as rig:
        assert settled(rig, *subject.question) == found[subject.place]
    assert outcomes == {False, True}
