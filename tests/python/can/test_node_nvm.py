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
from node_rig import DEADLINE_S, Rig, param_index, running
from quiesce.tune.phase_table import read_law
from quiesce.tune.phase_words import law_words

# hal/mps2/nvm_mps2.h, hal/records/nvm_records.h
MEMORY_BASE = 0x21000000
HALF_WORDS = 0x4000
HALVES = (0x21FE0000, 0x21FE0000 + 4 * HALF_WORDS)
HALF, ENTRY, WHOLE_WORD = 0x484D5651, 0x454D5651, 0x57505651
HEAD_WORDS, FIRST_AT, GAP_WORDS = 4, 8, 4
RECORDS = 6
ERASED = (0xFFFFFFFF,) * HEAD_WORDS
NO_BOARD = 0  # the memory's owner

PARAMS, LAW_TABLE, TRACKER_TABLE, LEARNT_RECORD = 0, 1, 2, 3  # records
LAW, TRACKER, LEARNT = 0, 1, 2  # roads
INFO_CRC, INFO_STORED_CRC, INFO_SOURCE, INFO_WRITES, INFO_RECORD = 0, 2, 3, 5, 7
SHIPS, FROM_STORE = 1, 3
WHOLE, OLDER = 0, 1  # how a record was found
PHASE, LINEAR = 4, 5  # laws
CURRENT = "constant_current_mA"
TRIM_WORD = 7  # of a record of what was learnt, after its own head and that of the law's words


def crc_of(*words: int) -> int:
    return zlib.crc32(struct.pack(f"<{len(words)}I", *words))


def head_of(magic: int, count: int, number: int) -> tuple[int, ...]:
    return (magic, count, number, crc_of(magic, count, number))


def tail_in(count: int) -> int:
    return HEAD_WORDS + -(-count // HEAD_WORDS) * HEAD_WORDS


@dataclass(frozen=True)
class Entry:
    """Of the log."""

    address: int
    record: int
    writes: int
    words: tuple[int, ...]
    is_whole: bool

    @property
    def tail(self) -> int:
        return self.address + 4 * tail_in(len(self.words))

    @property
    def end(self) -> int:
        return self.tail + 4 * HEAD_WORDS


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

    def half(self) -> int:
        """Address of the one that counts; the first one is made where there is none."""
        numbers = {}
        for base in HALVES:
            head = self.words(base, HEAD_WORDS)
            if head == head_of(HALF, 0, head[2]):
                numbers[head[2]] = base
        if not numbers:
            erased = (0xFFFFFFFF,) * (HALF_WORDS - FIRST_AT)
            self.write(HALVES[0], (*head_of(HALF, 0, 1), *head_of(HALF, 0, 1), *erased))
            return HALVES[0]
        return numbers[max(numbers)]

    def entry(self, address: int) -> Entry | None:
        """What begins there, whole or not."""
        head = self.words(address, HEAD_WORDS)
        magic, count, writes, _ = head
        if head != head_of(magic, count, writes) or not 0 <= magic - ENTRY < RECORDS:
            return None
        words = self.words(address + 4 * HEAD_WORDS, count)
        tail = self.words(address + 4 * tail_in(count), 2)
        is_whole = tail == (crc_of(NO_BOARD, *head, *words), WHOLE_WORD)
        return Entry(address, magic - ENTRY, writes, words, is_whole)

    def log(self) -> tuple[list[Entry], int]:
        """Its entries, and the address of its end."""
        found = []
        address = end = self.half() + 4 * FIRST_AT
        while address < self.half() + 4 * HALF_WORDS:
            entry = self.entry(address)
            if entry:
                found.append(entry)
                end = max(end, entry.end)
            elif address >= end and self.words(address, HEAD_WORDS) != ERASED:
                end = address + 4 * HEAD_WORDS
            address = entry.end if entry and entry.is_whole else address + 4 * HEAD_WORDS
        return found, end

    def newest(self, record: int) -> Entry:
        """What a start finds."""
        return [one for one in self.log()[0] if one.record == record and one.is_whole][-1]

    def put(self, record: int, words: Sequence[int]) -> None:
        """At the end of the log, as the image writes it."""
        entries, end = self.log()
        before = [one.writes for one in entries if one.record == record]
        self.put_at(end, record, max(before, default=0) + 1, words)

    def replace(self, record: int, words: Sequence[int]) -> None:
        """In place of what a start finds, which is as long."""
        newest = self.newest(record)
        assert len(newest.words) == len(words)
        self.put_at(newest.address, record, newest.writes, words)

    def put_at(self, address: int, record: int, writes: int, words: Sequence[int]) -> None:
        head = head_of(ENTRY + record, len(words), writes)
        rest = [0xFFFFFFFF] * (tail_in(len(words)) - HEAD_WORDS - len(words))
        tail = (crc_of(NO_BOARD, *head, *words), WHOLE_WORD)
        self.write(address, (*head, *words, *rest, *tail))


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

    def until_written(self, address: int) -> None:
        """The board runs until the word has just been written: it stops before that, and a step
        then does it."""
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
    # All that there is of it damaged: what ships is used, and others can be saved.
    for entry in memory.log()[0]:
        memory.flip(entry.address + 40)
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
        assert rig.ask("TABLE_SAVE", LAW)["result"] == "DONE"
    memory.put(LAW_TABLE, pulses(701))
    memory.put(LAW_TABLE, pulses(702))
    memory.flip(memory.newest(LAW_TABLE).address + 80)
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
        params = memory.newest(PARAMS).words
        return [(*params[:at], 700 + i, *params[at + 1 :]) for i in range(2)]
    if subject.record == LEARNT_RECORD:
        learnt = memory.newest(LEARNT_RECORD).words
        return [with_trim(learnt, 1 + i) for i in range(2)]
    if subject.record == TRACKER_TABLE:
        return [damper_map(400_000 + i) for i in range(2)]
    return [pulses(700 + i) for i in range(2)]


# Words of the entry after which the power goes; the last two are its tail's.
ANY = random.Random(20)
MOMENTS = [0, 2, 3, 4, ANY.randrange(5, 40), -2, -1]


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
    for word in MOMENTS:
        used = memory.newest(subject.record).words
        # The first save after a start leaves a gap.
        place = memory.log()[1] + 4 * GAP_WORDS
        last = place + 4 * (tail_in(len(used)) + 2)
        with running(image, (*memory.options(), *stub.options())) as rig:
            assert settled(rig, *subject.question) == used[subject.place]
            # Behind its back the record becomes the other one, which it replaces.
            memory.replace(subject.record, words[1 - words.index(used)])
            with stub.attached():
                operation, road = subject.save
                rig.send("ServiceRequest", operation=operation, param_index=road)
                stub.until_written((place if word >= 0 else last) + 4 * word)
                rig.cut_power()
        found = memory.newest(subject.record).words
        assert found in words
        outcomes.add(found == used)
    with running(image, memory.options()) as rig:
        assert settled(rig, *subject.question) == found[subject.place]
    assert outcomes == {False, True}
