"""`./tools/benchmark tables`: its parts are sound, and find what they are to find."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from queue import SimpleQueue

import isotp
import numpy as np
import pytest
from conftest import require
from quiesce.base.errors import BenchFailure
from quiesce.can import e2e
from quiesce.can.bus_load import frame_bits
from quiesce.can.database import load, shipped
from quiesce.table.file import read_data, table_bytes
from quiesce.table.kinds import KINDS, ROADS, RULES
from quiesce.table.words import sealed
from quiesce_benchmarks.part import all_parts
from quiesce_benchmarks.tables import bus_model, own_plant_page, parts
from quiesce_benchmarks.tables.bus import BITRATE, TABLE_DATA, Bus
from quiesce_benchmarks.tables.client import SLEW_mA
from quiesce_benchmarks.tables.foreign import (
    ForeignClient,
    Silence,
    crc8,
    file_of,
    frames_of,
    words_in,
)
from quiesce_benchmarks.tables.largest import largest
from quiesce_benchmarks.tables.line import DEMAND_ID, FAULT, RUN, is_frame, slcan
from quiesce_benchmarks.tables.parts import bump, cuts, own_plant, roads
from quiesce_benchmarks.tables.parts import load as load_part
from quiesce_benchmarks.tables.samples import all_samples
from quiesce_benchmarks.tables.targets import HostNode, SlowMps2Node

WORDS = sealed(RULES.magic, list(range(300)))
OTHER = sealed(RULES.magic, list(range(1, 301)))


def test_every_part_has_its_figures() -> None:
    found = all_parts(parts)
    assert list(found) == ["bump", "cost", "cuts", "load", "own_plant", "roads"]
    names = [name for part in found.values() for name, *_ in part.FIGURES]
    goals = {name: goal for part in found.values() for name, _, goal, _ in part.FIGURES}
    assert len(set(names)) == len(names)
    assert goals["table_roads_ok"] == goals["table_foreign_client_ok"] == len(KINDS) * len(ROADS)
    assert (goals["table_lost"], goals["bump_mA"], goals["own_plant_ok"]) == (0, 0, 5)
    assert (goals["load_s"], goals["instr_added"]) == (3, 30)


# A host of its own


@pytest.mark.parametrize("count", [1, 4, 300, 1016, 1017, 2045])
def test_the_foreign_host_makes_the_same_file_and_frames(count: int) -> None:
    words = sealed(RULES.magic, list(range(count)))
    data = file_of(words)
    assert data == table_bytes(words)
    assert words_in(data) == words == read_data(data).words
    assert frames_of(data) == library_frames(data)


def library_frames(data: bytes) -> list[bytes]:
    """As can-isotp sends them to a receiver that lets all of it go."""
    sent: list[bytes] = []
    flow = iter([isotp.CanMessage(arbitration_id=0x418, dlc=3, data=bytes([0x30, 0, 0]))])
    layer = isotp.TransportLayerLogic(
        rxfn=lambda _: next(flow, None) if sent else None,
        txfn=lambda frame: sent.append(bytes(frame.data)),
        address=isotp.Address(isotp.AddressingMode.Normal_11bits, txid=TABLE_DATA, rxid=0x418),
        params={"tx_data_min_length": 8, "max_frame_size": 1 << 16},
    )
    layer.send(data)
    while layer.transmitting():
        layer.process()
    return sent


@pytest.mark.parametrize("at", [0, 5, 9, 13, 21, 25, 200])
def test_a_damaged_file_is_no_table(at: int) -> None:
    data = bytearray(file_of(WORDS))
    data[at] ^= 1
    assert words_in(bytes(data)) == []


def test_its_crc_is_that_of_the_bus() -> None:
    assert crc8(b"123456789") == 0x4B == e2e.crc8(b"123456789")


class Echo:
    """A line on which every request is answered, the first one not at all."""

    def __init__(self) -> None:
        self.heard: SimpleQueue[bytes] = SimpleQueue()
        self.requests: list[bytes] = []

    def listen(self, _identifiers: object) -> SimpleQueue[bytes]:
        return self.heard

    def send(self, identifier: int, data: bytes) -> None:
        self.requests.append(data)
        assert data[-1] == e2e.frame_crc(identifier, data)
        if len(self.requests) == 1:
            return
        layout = load().by_name["ServiceReply"].protection
        assert layout is not None
        reply = e2e.protect(layout, load().raw(identifier, data)["alive"], bytes(8))
        self.heard.put(slcan(layout.frame_id, reply).rstrip())


def test_a_request_without_an_answer_is_asked_again(monkeypatch) -> None:
    monkeypatch.setattr("quiesce_benchmarks.tables.foreign.REPLY_S", 0.01)
    line = Echo()
    host = ForeignClient(shipped(), line)
    assert host.ask("TABLE_INFO", 0, 0) == ("DONE", 0)
    assert (len(line.requests), host.repeats) == (2, 1)


# The bus


def line_of(identifier: int, number: int = 0) -> bytes:
    return slcan(identifier, bytes([number] * 8))


@pytest.mark.parametrize(
    ("line", "is_one"),
    [
        (slcan(DEMAND_ID, bytes(4)).rstrip(), True),
        (b"t0200", True),
        (b"t01", False),
        (b"t0104AB", False),
        (b"t010t0104DC05559A", False),  # one that was cut off, and the next start's
        (b"t0104DC05559A00", False),
        (b"z", False),
    ],
)
def test_lines_of_a_program_that_was_killed_are_no_frames(line: bytes, is_one: bool) -> None:
    assert is_frame(line) == is_one


def test_the_lowest_id_goes_first_and_a_tick_has_its_bits() -> None:
    bus, passed = Bus(), []
    for identifier in (0x500, DEMAND_ID, 0x100, 0x200, 0x300):
        bus.put(line_of(identifier), lambda line: passed.append(int(line[1:4], 16)))
    bus.pass_tick()
    a_tick = BITRATE // 1000
    assert len(passed) == -(-a_tick // frame_bits(8)) == 4
    assert passed == [DEMAND_ID, 0x100, 0x200, 0x300]
    bus.pass_tick()
    assert passed[-1] == 0x500 and bus.bits == 5 * frame_bits(8)


def test_tables_keep_their_gap_and_their_order() -> None:
    bus, passed = Bus(), []
    for number in range(4):
        bus.put(line_of(TABLE_DATA, number), passed.append)
    counts = []
    for _ in range(8):
        bus.pass_tick()
        counts.append(len(passed))
    assert counts == [1, 1, 2, 2, 3, 3, 4, 4]
    assert passed == [line_of(TABLE_DATA, number) for number in range(4)]


def test_the_model_of_the_bus() -> None:
    """Gaps alone are its least; what is beside it makes it longer."""
    found = bus_model.transfer_s(load(), 4096)
    frames = bus_model.frames_of(4096)
    assert frames == len(frames_of(file_of(sealed(RULES.magic, [0] * 1017))))
    assert 1e-3 * bus_model.GAP_MS * (frames - 1) < found <= 3.0
    assert bus_model.transfer_s(load(), 2048) < 0.6 * found
    assert bus_model.busy_bits(3, []) == 3 * frame_bits(8)


# Its tables


def test_samples_are_of_every_kind_and_differ() -> None:
    samples = all_samples()
    assert {one.kind for one in samples} == set(KINDS.values()) and len(samples) == len(KINDS)
    for one in samples:
        assert one.first[0] != one.second[0] and one.first[1] != one.second[1]
        assert {one.first[0][0], one.second[0][0]} == {one.kind.magic}


def test_the_largest_tables_fill_what_there_is() -> None:
    rules = next(one for one in all_samples() if one.kind is RULES)
    for most in (400, 1020, 2048):
        assert most - 8 <= len(largest(rules, most).second[0]) <= most


# What goes wrong is found


def mangled(fault: str, at: int) -> list[bytes]:
    frames = frames_of(file_of(WORDS))
    mangle = cuts.mangler(fault, at, frames_of(file_of(OTHER)), np.random.default_rng(1))
    return [one for number, frame in enumerate(frames) for one in mangle(number, frame)]


def test_each_fault_is_the_one_that_it_is_called() -> None:
    frames = frames_of(file_of(WORDS))
    assert mangled("cut", 9) == frames[:9]
    assert mangled("repeated", 9) == [*frames[:10], *frames[9:]]
    assert mangled("reordered", 9) == [*frames[:9], frames[10], frames[9], *frames[11:]]
    damaged = mangled("damaged", 9)
    different = [i for i, one in enumerate(frames) if damaged[i] != one]
    assert different == [9] and len(damaged) == len(frames)
    both = mangled("two senders", 9)
    assert both[9:11] == [frames[9], frames_of(file_of(OTHER))[0]]


def test_every_block_of_a_transfer_has_its_fault() -> None:
    at = list(cuts.frames_at(200, 1))
    assert [frame // cuts.BLOCK for frame in at] == list(range(7)) and max(at) < 199
    assert len(list(cuts.frames_at(200, 3))) == 3


class Told:
    """A controller that tells of these tables."""

    def __init__(self, fetched: list[int], crc: int, stored_crc: int) -> None:
        self.fetched, self.crcs = fetched, {cuts.CRC: crc, cuts.STORED_CRC: stored_crc}

    def fetch(self, _road: int) -> list[int]:
        return self.fetched

    def info(self, _road: int, number: int) -> int:
        return self.crcs[number]


@pytest.mark.parametrize(
    ("told", "note"),
    [
        (Told(WORDS, WORDS[1], 0), ""),
        (Told(OTHER, OTHER[1], 0), f"{OTHER[1]:08x} is in use"),
        (Told([], 0, 0), "00000000 is in use"),
        (Told([*WORDS[:-1], 7], WORDS[1], 0), f"{WORDS[1]:08x} is in use"),  # a word of it
        (Told(WORDS, OTHER[1], 0), "it tells of another table than it sends"),
        (Told(WORDS, WORDS[1], 5), "00000005 is stored"),
    ],
)
def test_what_is_lost_is_noted(told: Told, note: str) -> None:
    scene = cuts.Scene(None, told, [], np.random.default_rng(1))  # type: ignore[arg-type]
    assert cuts.judge(scene, [WORDS], [0]) == note
    tally = cuts.Tally()
    tally.add("host", "cut", note)
    assert tally.lost["host", "cut"] == bool(note) and tally.trials["host", "cut"] == 1


def test_a_step_beyond_the_slew_is_found_and_a_gap_is_no_measurement() -> None:
    ramp = [(SLEW_mA * i, RUN, i % 16) for i in range(20)]
    assert bump.steps_mA(ramp) == [SLEW_mA] * 19
    sample = all_samples()[0]
    assert bump.row_of(sample, "host", 1, max(bump.steps_mA(ramp)))["beyond_mA"] == 0
    ramp[7] = (ramp[7][0] + 3, RUN, 7)
    assert bump.row_of(sample, "host", 1, max(bump.steps_mA(ramp)))["beyond_mA"] == 3
    with pytest.raises(BenchFailure, match="a demand is missing"):
        bump.steps_mA(ramp[:5] + ramp[6:])
    with pytest.raises(BenchFailure, match="it did not run"):
        bump.steps_mA([*ramp, (0, FAULT, 4)])


@pytest.fixture
def started(monkeypatch) -> Iterator[list[Path]]:
    """A target that is started costs nothing."""
    folders: list[Path] = []
    monkeypatch.setattr(HostNode, "start", lambda self: folders.append(self.folder))
    yield folders


@pytest.mark.parametrize("error", [BenchFailure, Silence, AssertionError])
def test_a_road_that_ends_before_its_end_says_why(started, error: type[Exception]) -> None:
    def way(*_: object) -> None:
        raise error("not so")

    sample = all_samples()[0]
    assert roads.why_not(HostNode, sample, way) == "not so"
    assert roads.why_not(HostNode, sample, lambda *_: None) == ""
    assert len(started) == 2


def test_ticks_that_every_load_costs_are_late() -> None:
    lost = [(7, 2), (3, 3), (1, 4)]
    rows = [{"lost": with_it, "lost_without": without} for with_it, without in lost]
    assert load_part.least_late(rows) == 0
    assert load_part.least_late([{"lost": n + 2, "lost_without": n} for n in (0, 5)]) == 2


# Own plants


def test_the_page_goes_all_the_way_for_any_of_its_structures() -> None:
    page = own_plant_page.page()
    assert list(page.new) == ["press", "boom", "mount", "tower", "corner"]
    way = own_plant.rules_way("boom", is_quick=False)
    assert way.make[:2] == ["rules", "optimize"] and "boom/steps.toml" in way.make
    assert way.run[0] == "hil" and "boom/rules/best.fcl" in way.run
    assert way.load == ["can", "load", "rules", "boom/rules/best.fcl", "--save"]
    quick = own_plant.rules_way("boom", is_quick=True)
    assert quick.make[quick.make.index("--generations") + 1] == "2"
    pulses = own_plant.pulses_way("mount", {"steps": [{"freq_Hz": 12.0}, {"freq_Hz": 40.0}]})
    assert pulses.make[pulses.make.index("--to-Hz") + 1] == "40"
    assert pulses.load == ["can", "load", "pulses", "mount/pulses", "--save"]


def test_a_page_without_a_step_is_told() -> None:
    text = (own_plant_page.root() / own_plant_page.PAGE).read_text()
    with pytest.raises(BenchFailure, match="no command with rules optimize"):
        own_plant_page.read_page(text.replace("rules optimize", "rules show"))


def metrics(*reductions_pct: float) -> dict:
    key = "accel_rms_mm_s2_reduction_pct"
    rows = [{"law": "fuzzy", "bodies": {"mass": {key: value}}} for value in reductions_pct]
    return {"rigs": [{"law": "open_loop", "bodies": {"mass": {key: 0.0}}}, *rows]}


@pytest.mark.parametrize(("reductions_pct", "is_ok"), [((20.0, 0.0), True), ((4.0, -4.0), False)])
def test_rules_that_do_not_calm_the_structure_are_no_success(
    monkeypatch, tmp_path: Path, reductions_pct, is_ok
) -> None:
    monkeypatch.setattr(own_plant, "quiesce", lambda *_: metrics(*reductions_pct))
    monkeypatch.setattr(own_plant, "at_work", lambda *_: "0badcafe")
    way = own_plant.rules_way("press", is_quick=True)
    row = own_plant.row_of(
        "press", "rules", lambda: own_plant.travel(tmp_path, "press", "mass", way)
    )
    assert (row["why"] == "") == is_ok
    assert row["crc"] == ("0badcafe" if is_ok else "")


# A road, whole


@pytest.mark.slow
@pytest.mark.parametrize("kind", [HostNode, SlowMps2Node])
def test_a_road_is_gone_and_a_wrong_claim_found(build: Path, monkeypatch, kind) -> None:
    require(build / "host/tools/benchmarks/host/tables/table_node")
    require(build / "mps2/targets/mps2/quiesce_mps2_node.elf")
    signs = next(one for one in all_samples() if one.name == "signs")
    words, current_mA = signs.first
    damaged = replace(signs, first=([*words[:-1], words[-1] ^ 1], current_mA))
    weaker = replace(signs, first=(words, 2 * current_mA))
    assert roads.why_not(kind, signs, roads.travel) == ""
    assert roads.why_not(kind, signs, roads.travel_foreign) == ""
    assert roads.why_not(kind, damaged, roads.travel_foreign) == "not so: it is taken"
    monkeypatch.setattr(kind, "patience_ticks", 2000)
    assert "not within 2000 ticks: 800 mA, but" in roads.why_not(kind, weaker, roads.travel)
