"""`quiesce can load` and its like beside a controller of the test's own, whose bus goes wrong."""

import itertools
import json
import re
import struct
import time
import zlib
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import ROOT
from quiesce.can import tables, transfer
from quiesce.can.database import load
from quiesce.can.link import Lost
from quiesce.can.parameters import parameters
from quiesce.can.refusals import VERDICTS, verdict_of, why_not_this_kind
from quiesce.can.roads import chooser_of, users_of
from quiesce.can.transfer import Channel, TransferFailed
from quiesce.cli.main import main
from quiesce.table import kinds
from quiesce.table.file import read_data
from table_controller import TableController, file_of

RULES, PULSES, MAP, LEARNT = (
    kind.magic for kind in (kinds.RULES, kinds.PULSES, kinds.MAP, kinds.LEARNT)
)
INDEX = {one["name"]: one["index"] for one in parameters()}
LABELS = {one["name"]: one["labels"] for one in parameters()}
NUMBERS = itertools.count()
SHORT = [4, 40]  # words
LONG = [pytest.param(count, marks=pytest.mark.slow) for count in (1019, 1020, 2048)]
SQUEEZE = ROOT / "firmware/plants/squeeze_2012"


def table(magic: int, count: int = 40) -> list[int]:
    after = [count, *range(count - 3)]
    return [magic, zlib.crc32(struct.pack(f"<{count - 2}I", *after)), *after]


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Silences are found out soon."""
    monkeypatch.setattr(transfer, "SILENCE_MS", 500)
    monkeypatch.setattr(tables, "BUSY_S", 2.0)
    monkeypatch.setattr(tables, "STORE_S", 0.3)
    monkeypatch.setattr(tables, "BEHIND_S", 0.01)


@pytest.fixture
def controller(quick: None) -> Iterator[TableController]:
    """Runs law fuzzy, tracker inverse, with rules that ship."""
    effective = {INDEX["law"]: LABELS["law"].index("fuzzy"), INDEX["tracker"]: 0}
    magics = {0: RULES, 1: MAP, 2: LEARNT}
    one = TableController(f"tables-{next(NUMBERS)}", effective, magics)
    one.roads[0].shipped = one.roads[0].words = table(RULES, 20)
    one.roads[0].source = 1
    one.start()
    yield one
    one.stop()


@pytest.fixture
def tool(controller: TableController, capsys: pytest.CaptureFixture[str]):
    """Runs an action on the controller's bus."""
    bus = f"virtual:{controller._bus.channel_id}"

    def run(*arguments: str | Path) -> SimpleNamespace:
        code = main(["can", *map(str, arguments), "--bus", bus])
        out, err = capsys.readouterr()
        return SimpleNamespace(returncode=code, stdout=out, stderr=err)

    return run


def written(path: Path, words: list[int]) -> Path:
    path.write_bytes(file_of(words))
    return path


def failed(result: SimpleNamespace, words: str, code: int = 1) -> None:
    assert result.returncode == code and result.stdout == "", result
    last = result.stderr.splitlines()[-1]
    assert last.startswith("quiesce: ") and words in last, result.stderr


# Loading


def test_rules_are_compiled_loaded_and_told(controller, tool) -> None:
    before = controller.roads[0].words
    result = tool("load", "rules", SQUEEZE / "rules.fcl")
    assert result.returncode == 0, result.stderr
    words = controller.roads[0].words
    assert words != before and controller.roads[0].previous == before
    assert f"rules, {len(words)} words, CRC {words[1]:08x}" in result.stdout
    assert "stored  no" in result.stdout and "back    quiesce can revert law" in result.stdout
    assert f"{16 + 4 * len(words)} bytes, 100 %" in result.stderr and "in use" in result.stderr
    assert controller.roads[0].stored == []


@pytest.mark.parametrize("count", SHORT + LONG)
def test_tables_of_all_lengths_arrive(controller, tool, tmp_path: Path, count: int) -> None:
    """4095 bytes are the last that a short first frame can say: 1019 words are 4092."""
    words = table(RULES, count)
    result = tool("load", "rules", written(tmp_path / "a.table", words), "--json")
    assert result.returncode == 0, result.stderr
    report = json.loads(result.stdout)
    assert (report["words"], report["crc"]) == (count, f"{words[1]:08x}")
    assert report["is_in_use"] and not report["is_saved"]
    assert controller.roads[0].words == words
    assert (controller.frames[0][:2] == b"\x10\0") == (count > 1019)


@pytest.mark.slow
def test_pulses_of_a_folder_a_law_file_and_a_table(controller, tool, tmp_path: Path) -> None:
    controller.magics[0] = PULSES
    law = (SQUEEZE / "pulses.phase.toml").read_text()
    folder = tmp_path / "tuned"
    folder.mkdir()
    (folder / "mine.phase.toml").write_text(law)
    (tmp_path / "tuned.toml").write_text(law)
    loaded = []
    for file in (folder, tmp_path / "tuned.toml"):
        assert tool("load", "pulses", file).returncode == 0
        loaded.append(controller.roads[0].words)
    written(tmp_path / "a.table", loaded[0])
    assert tool("load", "pulses", tmp_path / "a.table").returncode == 0
    assert tool("load", "law", tmp_path / "a.table").returncode == 0
    assert loaded[0] == loaded[1] == controller.roads[0].words


def test_a_dry_run_changes_nothing(controller, tool, tmp_path: Path) -> None:
    before = controller.roads[0].words
    file = written(tmp_path / "a.table", table(RULES))
    result = tool("load", "law", file, "--dry-run", "--save")
    assert result.returncode == 0 and "would take it" in result.stdout
    assert not {"TABLE_COMMIT", "TABLE_SAVE"} & set(controller.requests)
    assert controller.roads[0].words == before


def test_a_table_is_stored_and_its_failure_told(controller, tool, tmp_path: Path) -> None:
    words = table(MAP)
    file = written(tmp_path / "a.table", words)
    result = tool("load", "tracker", file, "--save")
    assert result.returncode == 0 and "stored  for the next start" in result.stdout
    assert controller.roads[1].stored == words
    controller.faults.results["TABLE_SAVE"] = ("STORE_FAILED", 0)
    failed(tool("load", "tracker", file, "--save"), "in use, but not stored for the next start")


def test_what_was_learnt_goes_the_same_way(controller, tool, tmp_path: Path) -> None:
    words = table(LEARNT, 100)
    result = tool("load", "learnt", written(tmp_path / "a.table", words))
    assert result.returncode == 0 and "quiesce can forget-learnt" in result.stdout
    assert controller.roads[2].words == words


def test_a_controller_that_says_otherwise_is_not_believed(controller, tool, tmp_path) -> None:
    controller.faults.ignores_commit = True
    failed(tool("load", "law", written(tmp_path / "a.table", table(RULES))), "says that it uses")


# A bus that goes wrong


@pytest.mark.parametrize("lost", [{0}, {1}, {20}, {33, 60}, {24, 25, 26}, {5, 40, 41, 42}])
def test_lost_frames_cost_a_try(controller, tool, tmp_path: Path, lost: set[int]) -> None:
    """Of 25 frames a transfer: the first, one in the middle, the last, some of two transfers."""
    words = table(RULES)
    controller.faults.lose_data = lost
    result = tool("load", "law", written(tmp_path / "a.table", words))
    assert result.returncode == 0, result.stderr
    assert controller.roads[0].words == words


def test_a_bus_that_always_loses_frames_is_given_up(controller, tool, tmp_path: Path) -> None:
    before = controller.roads[0].words
    file = written(tmp_path / "a.table", table(RULES, 400))
    controller.faults.lose_data = set(range(3, 10_000, 20))
    failed(
        tool("load", "law", file), "3 transfers failed, the last one because the controller gave"
    )
    controller.faults.lose_data = set(range(0, 10_000))
    failed(tool("load", "law", file), "gave no flow control")
    assert controller.roads[0].words == before


def test_the_last_frame_lost_each_time(controller, tool, tmp_path: Path) -> None:
    """Nothing but the check tells."""
    controller.faults.lose_data = {24, 49, 74}
    file = written(tmp_path / "a.table", table(RULES))  # 176 bytes: 25 frames
    failed(tool("load", "law", file), "because the controller did not get all of it")


def test_no_flow_control(controller, tool, tmp_path: Path) -> None:
    controller.faults.has_flow_control = False
    file = written(tmp_path / "a.table", table(RULES))
    failed(tool("load", "law", file), "the controller gave no flow control for 0.5 s")


@pytest.mark.parametrize(("waits", "code"), [(3, 0), (50, 1)])
def test_a_controller_that_asks_to_wait(controller, tool, tmp_path: Path, waits, code) -> None:
    controller.faults.waits = waits
    result = tool("load", "law", written(tmp_path / "a.table", table(RULES)))
    assert result.returncode == code, result.stderr
    assert code == 0 or "asks to wait, again and again" in result.stderr


def test_a_controller_without_room_is_asked_once(controller, tool, tmp_path: Path) -> None:
    controller.faults.most_bytes = 100
    file = written(tmp_path / "a.table", table(RULES))
    failed(
        tool("load", "law", file),
        "the controller has no room for 176 bytes at a time; where it is still storing",
    )
    assert len([one for one in controller.frames if one[0] >> 4 == 1]) == 1


@pytest.mark.slow
def test_a_silent_controller(controller, tool, tmp_path: Path) -> None:
    controller.faults.is_silent = True
    file = written(tmp_path / "a.table", table(RULES))
    for words in (["load", "law", file], ["tables"], ["revert", "law"], ["forget-learnt"]):
        failed(tool(*words), "no controller answers")
    failed(tool("fetch", "law", "-o", tmp_path / "b.table"), "no controller answers")
    assert not (tmp_path / "b.table").exists()


def test_older_firmware(controller, tool, tmp_path: Path) -> None:
    controller.faults.is_old = True
    file = written(tmp_path / "a.table", table(RULES))
    failed(tool("load", "law", file), "this controller's firmware takes no tables over CAN")
    assert controller.frames == []


def test_busy_controllers_are_waited_for(controller, tool, tmp_path: Path) -> None:
    words = table(RULES)
    file = written(tmp_path / "a.table", words)
    controller.faults.busy = {"TABLE_CHECK": 3, "TABLE_COMMIT": 12, "TABLE_INFO": 2}
    assert tool("load", "law", file).returncode == 0
    assert controller.roads[0].words == words
    controller.faults.busy = {"TABLE_COMMIT": 1_000_000}
    failed(tool("load", "law", file), "busy with another table")


@pytest.mark.parametrize(
    "operation", ["TABLE_INFO", "TABLE_CHECK", "TABLE_COMMIT", "TABLE_SAVE", "TABLE_REVERT"]
)
def test_lost_replies_change_nothing(controller, tool, tmp_path: Path, operation: str) -> None:
    """A request that was acted on is asked again."""
    before, words = controller.roads[0].words, table(RULES)
    controller.faults.lose_replies = {operation: 1}
    result = tool("load", "law", written(tmp_path / "a.table", words), "--save")
    assert result.returncode == 0, result.stderr
    assert controller.roads[0].words == controller.roads[0].stored == words
    assert tool("revert", "law").returncode == 0
    assert controller.roads[0].words == before


# Refusals


@pytest.mark.parametrize("number", [n for n in VERDICTS if n > 2])
def test_refusals_are_told_in_words(controller, tool, tmp_path: Path, number: int) -> None:
    before = controller.roads[0].words
    controller.verdict = number
    file = written(tmp_path / "a.table", table(RULES))
    failed(tool("load", "law", file), f"refused: {verdict_of(number).text}; nothing was changed")
    assert controller.roads[0].words == before
    assert verdict_of(number).why in tool("tables").stdout


def test_the_wrong_law_is_named_with_what_to_set(controller, tool, tmp_path: Path) -> None:
    file = written(tmp_path / "a.table", table(PULSES))
    failed(
        tool("load", "pulses", file),
        "refused: the controller runs law fuzzy, which takes rules; this is pulses, for law phase: "
        "quiesce can set law=phase; nothing was changed",
    )


def test_what_runs_is_named_for_every_kind() -> None:
    assert (
        "runs law off, which takes no table; this is rules, for law fuzzy or fuzzy_selftune: "
        in (why_not_this_kind(kinds.RULES, "off", "inverse"))
    )
    assert "runs tracker inverse, which takes map; this is bank, for tracker bank: " in (
        why_not_this_kind(kinds.BANK, "linear", "inverse")
    )
    assert "law fuzzy, which demands a current" in (
        why_not_this_kind(kinds.MAP, "fuzzy", "inverse")
    )
    assert "of another version" in why_not_this_kind(kinds.RULES, "fuzzy", "inverse")


def test_what_was_learnt_of_another_law_is_refused(controller, tool, tmp_path: Path) -> None:
    controller.faults.results["LEARNT_RESTORE"] = ("TABLE_REFUSED", 2)
    failed(tool("restore-learnt"), "refused: it was learnt by another law")
    controller.verdict = 8
    file = written(tmp_path / "a.table", table(LEARNT))
    failed(tool("restore-learnt", file), "refused: it was learnt by another law")


def test_a_verdict_of_younger_firmware_is_told_by_its_number(controller, tool, tmp_path) -> None:
    controller.verdict = 77
    failed(tool("load", "law", written(tmp_path / "a.table", table(RULES))), "verdict 77")


# Bad input


def bad_files() -> dict[str, tuple[str, bytes, str]]:
    good = file_of(table(RULES))
    damaged = good[:-1] + bytes([good[-1] ^ 1])
    many = file_of(table(RULES, 2049))
    return {
        "empty": ("a.table", b"", "not a table file"),
        "short": ("a.table", good[:-4], "ends after 39 words, 156 bytes where its head says 40"),
        "odd": ("a.table", good + b"\0", "goes on after the 40 words"),
        "damaged": ("a.table", damaged, "damaged"),
        "head": ("a.table", b"\0" + good[1:], "not a table file"),
        "board": ("a.table", good[:4] + b"\1" + good[5:], "CRC-32 of its head is wrong"),
        "large": (
            "a.table",
            many,
            "2049 words, 8196 bytes; a controller takes 2048 words, 8192 bytes",
        ),
        "kind": ("a.table", file_of(table(0x12345678)), "no known kind"),
        "other": ("a.table", file_of(table(PULSES)), "quiesce can load pulses"),
        "suffix": ("a.txt", good, "not a rule file"),
        "rules": ("a.fcl", b"nonsense", "a.fcl:1:1"),
    }


@pytest.mark.parametrize("name", bad_files())
def test_bad_files_are_refused_before_anything_is_sent(
    controller, tool, tmp_path: Path, name: str
) -> None:
    file, data, words = bad_files()[name]
    (tmp_path / file).write_bytes(data)
    failed(tool("load", "rules", tmp_path / file), words, 2)
    assert controller.requests == [] and controller.frames == []


def test_bad_paths_are_refused_before_anything_is_sent(controller, tool, tmp_path: Path) -> None:
    (tmp_path / "two").mkdir()
    for name in ("a.phase.toml", "b.phase.toml"):
        (tmp_path / "two" / name).write_text("")
    for words, text in (
        (["load", "law", tmp_path / "no.table"], "no.table"),
        (["load", "law", tmp_path / "no.toml"], "its name ends in .table"),
        (["load", "pulses", tmp_path], "no NAME.phase.toml"),
        (["load", "pulses", tmp_path / "two"], "which of a.phase.toml, b.phase.toml?"),
        (["fetch", "law", "-o", tmp_path], "a folder"),
        (["load", "colours", "a.table"], "colours"),
        (["revert", "learnt"], "learnt"),
    ):
        failed(tool(*words), text, 2)
    assert controller.requests == []


# Telling, going back, fetching


def test_tables_are_told(controller, tool, tmp_path: Path) -> None:
    road = controller.roads[0]
    words = table(RULES)
    assert tool("load", "law", written(tmp_path / "a.table", words), "--save").returncode == 0
    road.refusal = 10
    report = json.loads(tool("tables", "--json").stdout)
    assert report["board"] == "b0a2d000"
    law, tracker, learnt = report["roads"]
    crc = f"{words[1]:08x}"
    assert (law["kind"], law["crc"], law["stored_crc"]) == ("rules", crc, crc)
    assert (law["source"], law["writes"]) == ("loaded", 1)
    assert law["refusal"]["verdict"] == "BOARD"
    assert (tracker["kind"], tracker["crc"], tracker["refusal"]) == ("none", None, None)
    assert learnt["road"] == "learnt"
    text = tool("tables").stdout
    assert re.search(rf"law +rules +{crc} +loaded +{crc} +1", text)
    assert "last refusal on road law: it is made for another board" in text


def test_records_that_are_not_whole_are_told(controller, tool) -> None:
    law, tracker, learnt = controller.roads
    law.record, tracker.record, learnt.record = 1, 2, None  # None: older firmware
    report = json.loads(tool("tables", "--json").stdout)
    assert [one["record"] for one in report["roads"]] == ["older", "lost", None]
    text = tool("tables").stdout
    assert "record of road law: a copy is damaged" in text
    assert "record of road tracker: damaged, or of another board, and not used" in text
    assert "record of road learnt" not in text
    law.record = tracker.record = 0
    assert "record of" not in tool("tables").stdout


def test_revert_and_what_ships(controller, tool, tmp_path: Path) -> None:
    shipped = controller.roads[0].words
    failed(tool("revert", "law"), "there is no earlier table")
    first, second = table(RULES, 30), table(RULES, 31)
    for words in (first, second):
        assert tool("load", "law", written(tmp_path / "a.table", words), "--save").returncode == 0
    result = tool("revert", "law")
    assert f"rules {second[1]:08x} -> rules {first[1]:08x} (loaded)" in result.stdout
    assert f"stored for the next start: {second[1]:08x}" in result.stdout
    report = json.loads(tool("revert", "law", "--shipped", "--save", "--json").stdout)
    assert report["crc"] == f"{shipped[1]:08x}" and report["source"] == "ships"
    assert controller.roads[0].stored == []


@pytest.mark.parametrize("count", SHORT + LONG)
def test_fetched_files_are_whole(controller, tool, tmp_path: Path, count: int) -> None:
    words = table(RULES, count)
    controller.roads[0].words = words
    out = tmp_path / "new" / "a.table"
    result = tool("fetch", "law", "-o", out)
    assert result.returncode == 0, result.stderr
    assert out.read_bytes() == file_of(words, controller.board)
    assert f"rules, {count} words" in result.stdout


@pytest.mark.parametrize("lost", [{0}, {7}, {24}, {3, 30}])
def test_lost_frames_are_fetched_again(controller, tool, tmp_path: Path, lost: set[int]) -> None:
    controller.roads[0].words = table(RULES)
    controller.faults.lose_flow = lost
    assert tool("fetch", "law", "-o", tmp_path / "a.table").returncode == 0
    assert read_data((tmp_path / "a.table").read_bytes()).words == table(RULES)


def test_frames_that_come_twice_and_fetches_that_fail(controller, tool, tmp_path: Path) -> None:
    controller.roads[0].words = table(RULES)
    controller.faults.twice_flow = {9}
    assert tool("fetch", "law", "-o", tmp_path / "a.table").returncode == 0
    controller.faults.twice_flow = set(range(0, 100_000, 10))
    failed(tool("fetch", "law", "-o", tmp_path / "b.table"), "a frame was lost or came twice")
    failed(tool("fetch", "tracker", "-o", tmp_path / "b.table"), "road tracker has no table")
    assert not (tmp_path / "b.table").exists()


def test_a_lost_reply_of_a_fetch(controller, tool, tmp_path: Path) -> None:
    controller.faults.lose_replies = {"TABLE_SEND": 1}
    assert tool("fetch", "law", "-o", tmp_path / "a.table").returncode == 0


def test_learnt_is_kept_put_back_and_forgotten(controller, tool, tmp_path: Path) -> None:
    failed(tool("restore-learnt"), "nothing that was learnt is stored")
    words, file = table(LEARNT), tmp_path / "learnt.table"
    controller.roads[2].words = words
    assert f"{words[1]:08x}" in tool("save-learnt", file).stdout
    assert read_data(file.read_bytes()).words == controller.roads[2].stored == words
    assert "forgotten" in tool("forget-learnt").stdout
    assert controller.roads[2].words == []
    failed(tool("fetch", "learnt", "-o", file), "has no table")
    assert tool("restore-learnt").returncode == 0 and controller.roads[2].words == words
    controller.roads[2].words = []
    assert tool("restore-learnt", file).returncode == 0 and controller.roads[2].words == words


# A transfer by itself


class ScriptedLink:
    """Gives events, takes so many frames."""

    def __init__(self, events: list[object], room: int = 1_000) -> None:
        self.events, self.room, self.is_up = events, room, True

    def receive(self, _timeout_s: float) -> object:
        return self.events.pop(0) if self.events else None

    def receive_now(self) -> None:
        return None

    def send(self, *_: object) -> object:
        self.room -= 1
        return self if self.room >= 0 else None


@pytest.mark.parametrize(
    ("link", "why"),
    [
        (ScriptedLink([Lost(0.0, "unplugged")]), "the bus was lost: unplugged"),
        (ScriptedLink([], room=0), "the bus takes no frames"),
    ],
)
def test_a_bus_that_goes_away_ends_a_transfer(quick: None, link: ScriptedLink, why: str) -> None:
    with pytest.raises(TransferFailed, match=why):
        Channel(link, load()).send(bytes(100))


def test_a_bus_that_stays_away(quick: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transfer, "UP_S", 0.05)
    link = ScriptedLink([])
    link.is_up = False
    with pytest.raises(TransferFailed, match="the bus is down"):
        Channel(link, load()).send(bytes(100))


def test_other_lengths_and_silence_are_no_transfer(quick: None) -> None:
    for first, why in (
        (None, "nothing came"),
        (b"\x10\x20" + bytes(6), "more bytes came than were said"),
        (b"\x07" + bytes(7), "7 bytes came, not 16"),
        (b"\x40" + bytes(7), "none of ISO-TP"),
        (b"\x10\x10" + bytes(6), "no frame came for 0.5 s"),
    ):
        link = ScriptedLink([])
        channel = Channel(link, load())
        channel.begin()
        if first:
            channel.take(SimpleNamespace(arbitration_id=0x418, is_extended_id=False, data=first))
        with pytest.raises(TransferFailed, match=why):
            channel.receive(16)


def test_late_frames_of_an_earlier_try_do_no_harm(quick: None) -> None:
    channel = Channel(ScriptedLink([]), load())
    channel.begin()
    late = (b"\x25" + bytes(7), b"\x30\0\0".ljust(8))
    whole = (b"\x10\x10ABCDEF", b"\x21GHIJKLM", b"\x22NOP".ljust(8))
    for data in (*late, *whole):
        channel.take(SimpleNamespace(arbitration_id=0x418, is_extended_id=False, data=data))
    assert channel.receive(16) == b"ABCDEFGHIJKLMNOP"


# One source


def test_verdicts_are_the_firmwares() -> None:
    header = (ROOT / "firmware/include/quiesce.h").read_text()
    body = header.split("} quiesce_table_verdict_t;")[0].rsplit("typedef enum {", 1)[1]
    rows = {int(n): label for label, n in re.findall(r"QUIESCE_TABLE_(\w+) = (\d+),", body)}
    assert {number: one.label for number, one in VERDICTS.items()} == rows


def test_who_works_with_a_kind_is_there() -> None:
    for kind in kinds.KINDS.values():
        assert set(users_of(kind)) <= set(LABELS[chooser_of(kind)])


def test_the_page_is_enough(controller, tool, tmp_path: Path, monkeypatch) -> None:
    """Its numbers, and its program."""
    page = (ROOT / "docs/reference/can-messages.md").read_text().split("\n## Tables\n")[1]
    rows = re.findall(r"^\| (\d+) \| ([A-Z]+) \| ", page, re.M)
    assert {int(n): label for n, label in rows} == {n: v.label for n, v in VERDICTS.items() if n}
    named = re.findall(r"(\w+) 0x([0-9A-F]{8})", page.split("### The transfer")[0])
    names = {kind.name: kind.magic for kind in kinds.KINDS.values()}
    assert {name: int(n, 16) for name, n in named} == names
    choices = load().codec.get_message_by_name("ServiceRequest").get_signal_by_name("operation")
    told = re.findall(r"^\| ((?:TABLE|LEARNT)_\w+) \|", page, re.M)
    assert told == [
        one for one in map(str, choices.choices.values()) if one[:6] in ("TABLE_", "LEARNT")
    ]
    program = page.split("```python\n")[1].split("```")[0]
    bus = f'can.Bus(interface="virtual", channel="{controller._bus.channel_id}")'
    words = table(RULES, 400)
    written(tmp_path / "mine.table", words)
    monkeypatch.chdir(tmp_path)
    exec(re.sub(r"can\.Bus\(.*\)", bus, program), {})  # noqa: S102
    end_s = time.monotonic() + 5.0
    while not controller.received and time.monotonic() < end_s:
        time.sleep(0.01)
    assert controller.received == file_of(words)


def test_a_table_does_not_go_to_a_controller_of_other_messages(
    controller: TableController, tool, tmp_path: Path
) -> None:
    controller.faults.interface_version = 4
    result = tool("load", "rules", written(tmp_path / "a.table", table(RULES)))
    assert result.returncode == 2 and "version 4 of the CAN messages" in result.stderr
    assert controller.requests == [] and controller.frames == []
