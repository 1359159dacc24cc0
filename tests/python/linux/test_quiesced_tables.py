"""Tables of a running `quiesced`: loaded over the bus, kept over its death, configured, refused."""

import signal
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from quiesced_peer import Quiesced, on_a_pty
from quiesced_steps import RUN, SAFE, killed, set_parameter, start_running
from table_host import (
    BOARD,
    CAN,
    CONFIGURATION,
    CRC,
    DONE,
    LAW,
    LEARNT,
    MAGIC,
    NOTHING_RECEIVED,
    NOTHING_TO_SEND,
    OVERFLOW,
    RECORD,
    REFUSAL,
    SHIPS,
    SOURCE,
    STORE_FAILED,
    STORED,
    STORED_CRC,
    TABLE_REFUSED,
    TRACKER,
    WRITES,
    TableHost,
    file_of,
    first_of,
    table,
    words_of,
)

VERDICT_MAGIC, VERDICT_CRC, VERDICT_BOARD = 2, 3, 10
INIT, ARMED, DEGRADED, SELF_TEST = 0, 5, 6, 7
RATE_Hz = 500
PHASE = 4  # the law
# A force against the velocity of the body, no states: one input (a body's velocity, at most 1 m/s,
# as it is), one row (damper 0, a shift of 10, at most 500 N, the gain).
LINEAR = table([0x314E4C51, 0, 0, RATE_Hz, 0, 1, 1, 0x001, 1_000_000, 0, 0, 10, 500_000, 2_000])
# A damper's forces over stroke velocity, 4 places, and current, 3 of them.
MAP = table(
    [0x32464D51, 0, 0, 1, 4, 4, 3, -200_000, -1_000, 1_000, 200_000, 0, 700, 1_500]
    + [-90_000, -400_000, -700_000, -20_000, -300_000, -500_000]
    + [20_000, 300_000, 500_000, 90_000, 400_000, 700_000]
)
FORCES = "law = 'linear'\ntracker = 'inverse'\n"


@pytest.fixture
def quiesced(tmp_path: Path) -> Iterator[Quiesced]:
    with on_a_pty(tmp_path) as under_test:
        yield under_test


def restart(quiesced: Quiesced) -> None:
    """After a death without any warning."""
    killed(quiesced)
    assert quiesced.run("--make-safe").returncode == 0  # it waits for the caretaker
    quiesced.start()


def states_since(quiesced: Quiesced, after: int) -> set[int]:
    frames = quiesced.peer.frames[after : quiesced.peer.count()]
    return {frame.signals["state"] for frame in frames if frame.name == "CurrentDemand"}


def is_armed_since(quiesced: Quiesced, after: int) -> bool:
    """Lost ticks of a busy machine may have led to SAFE, and from there back."""
    return states_since(quiesced, after) <= {RUN, SAFE, ARMED, DEGRADED}


def others(host: TableHost, count: int) -> list[list[int]]:
    """Good tables that differ from the law's in a bit near their end."""
    shipped = words_of(host.fetch(LAW))
    found: list[list[int]] = []
    for at in range(len(shipped) - 1, 2, -1):
        words = list(shipped)
        words[at] ^= 1
        words = table(words)
        if host.load(file_of(words), words[1], "TABLE_CHECK")[0] == DONE:
            found.append(words)
        if len(found) == count:
            break
    return found


@pytest.mark.parametrize("law", ["fuzzy", "phase"])
def test_loaded_table_outlives_the_program(quiesced: Quiesced, law: str) -> None:
    quiesced.write_config(f"law = '{law}'\n")
    quiesced.start()
    host = TableHost(quiesced.peer)
    shipped = host.info(LAW, CRC)
    assert host.info(LAW, SOURCE) == SHIPS
    first, second = others(host, 2)
    assert host.info(LAW, CRC) == shipped  # a check changes nothing

    host.use(first)
    host.use(second)
    assert [host.info(LAW, number) for number in (CRC, MAGIC, STORED_CRC, SOURCE, BOARD)] == [
        second[1],
        second[0],
        0,
        CAN,
        0,
    ]
    assert host.ask("TABLE_REVERT", LAW)[0] == DONE
    assert host.info(LAW, CRC) == first[1]
    assert words_of(host.fetch(LAW)) == first
    assert host.ask("TABLE_SAVE", LAW) == (DONE, 0)
    assert (host.info(LAW, STORED_CRC), host.info(LAW, WRITES)) == (first[1], 1)

    restart(quiesced)
    assert (host.info(LAW, CRC), host.info(LAW, SOURCE)) == (first[1], STORED)
    assert words_of(host.fetch(LAW)) == first
    status = quiesced_status(quiesced)["tables"]["law"]
    assert (status["crc"], status["stored_crc"], status["writes"]) == (first[1], first[1], 1)
    assert (status["source"], status["refusal"]) == ("stored", None)

    assert host.ask("TABLE_SHIP", LAW)[0] == DONE
    assert (host.info(LAW, CRC), host.info(LAW, SOURCE)) == (shipped, SHIPS)
    assert host.ask("TABLE_SAVE", LAW) == (DONE, 0)
    restart(quiesced)
    assert (host.info(LAW, CRC), host.info(LAW, SOURCE)) == (shipped, SHIPS)
    assert (host.info(LAW, STORED_CRC), host.info(LAW, WRITES)) == (0, 2)
    assert host.ask("TABLE_REVERT", LAW)[0] == NOTHING_TO_SEND
    assert quiesced.stop() == 0
    log = quiesced.log_text()
    assert log.count("saved: the law's table") == 1
    assert log.count("forgotten: the law's table") == 1
    assert log.count(f"CRC {first[1]:08x} (stored)") == 1


def quiesced_status(quiesced: Quiesced) -> dict:
    """As it is after a tick from now on."""
    ticks = quiesced.status()["loop"]["ticks"]
    quiesced.signal(signal.SIGUSR1)
    while (status := quiesced.status())["loop"]["ticks"] == ticks:
        quiesced.peer.wait("Status", after=quiesced.peer.count())
    return status


def test_law_and_tracker_without_shipped_tables_run_once_they_have_theirs(
    quiesced: Quiesced,
) -> None:
    quiesced.write_config(FORCES)
    peer, host = quiesced.peer, TableHost(quiesced.peer)
    peer.operator = {"enable": 1}
    quiesced.start()
    quiesced.wait_log("linear has no table")
    assert (host.info(LAW, CRC), host.info(LAW, SOURCE)) == (0, 0)
    assert host.ask("TABLE_SEND", LAW)[0] == NOTHING_TO_SEND
    for _ in range(5):
        peer.wait("Status", lambda s: s["is_enabled"] == 1, peer.count())
    assert states_since(quiesced, 0) <= {INIT, SAFE, SELF_TEST}

    host.use(LINEAR)
    quiesced.wait_log("inverse has no table")
    host.use(MAP)
    peer.wait_state(RUN, peer.count())
    after = peer.count()
    peer.wait("CurrentDemand", lambda s: s["current_cmd_mA"] > 0, after)
    host.use(MAP)
    host.use(LINEAR)
    assert is_armed_since(quiesced, after)
    for road in (LAW, TRACKER):
        assert host.ask("TABLE_SAVE", road) == (DONE, 0)
    restart(quiesced)
    assert (host.info(LAW, CRC), host.info(TRACKER, CRC)) == (LINEAR[1], MAP[1])
    assert host.info(TRACKER, SOURCE) == STORED
    assert words_of(host.fetch(TRACKER)) == MAP
    status = quiesced_status(quiesced)["tables"]
    assert [status[road]["kind"] for road in ("law", "tracker", "learnt")] == [
        "linear",
        "map",
        None,
    ]
    assert quiesced.stop() == 0


def test_tables_are_used_again_after_other_parameters(quiesced: Quiesced) -> None:
    quiesced.start()
    host = TableHost(quiesced.peer)
    set_parameter(quiesced.peer, "law", 2)
    (words,) = others(host, 1)
    host.use(words)
    set_parameter(quiesced.peer, "safe_current_mA", 40)
    assert host.info(LAW, CRC) == words[1]
    assert quiesced.stop() == 0


def test_what_is_refused_changes_nothing(quiesced: Quiesced) -> None:
    quiesced.write_config("law = 'fuzzy'\n")
    quiesced.start()
    host = TableHost(quiesced.peer)
    shipped = host.info(LAW, CRC)
    good = words_of(host.fetch(LAW))
    damaged = [*good[:-1], good[-1] ^ 1]
    assert host.load(file_of(damaged), good[1]) == (TABLE_REFUSED, VERDICT_CRC)
    strange = table([LINEAR[0], *good[1:]])
    assert host.load(file_of(strange), strange[1]) == (TABLE_REFUSED, VERDICT_MAGIC)
    assert host.load(file_of(good, board=1), good[1]) == (TABLE_REFUSED, VERDICT_BOARD)
    assert host.info(LAW, REFUSAL) == VERDICT_BOARD
    host.send(file_of(good))
    assert host.ask("TABLE_COMMIT", LAW, good[1] ^ 1)[0] == NOTHING_RECEIVED
    assert host.ask("TABLE_COMMIT", LAW, good[1])[0] == DONE
    assert host.ask("TABLE_COMMIT", LAW, good[1])[0] == NOTHING_RECEIVED
    after = quiesced.peer.count()
    host._send(first_of(bytes(4 * 2048 + 17))[0])
    assert host._await_flow(after)[0] == OVERFLOW
    assert host.info(LAW, CRC) == shipped
    assert quiesced_status(quiesced)["tables"]["law"]["refusal"] is None
    assert quiesced.stop() == 0


@dataclass(frozen=True)
class Kept:
    """A record, with a controller that stores it; words: of its table, none of what was learnt."""

    road: int
    file: str
    parameters: str
    words: list[int] | None
    name: str


KEPT = [
    Kept(LAW, "law_table.bin", FORCES, LINEAR, "the law's table as stored"),
    Kept(TRACKER, "tracker_table.bin", FORCES, MAP, "the tracker's table as stored"),
    Kept(LEARNT, "learnt.bin", "law = 'phase'\n", None, "what was learnt"),
]
each_record = pytest.mark.parametrize("kept", KEPT, ids=("law", "tracker", "learnt"))
WHOLE, LOST = 0, 2


def stored(quiesced: Quiesced, kept: Kept) -> Path:
    """The file of a record that a controller has stored, which has ended."""
    quiesced.write_config(kept.parameters)
    quiesced.start()
    host = TableHost(quiesced.peer)
    if kept.words is not None:
        host.use(kept.words)
    assert host.ask("TABLE_SAVE", kept.road) == (DONE, 0)
    assert (host.info(kept.road, RECORD), host.info(kept.road, WRITES)) == (WHOLE, 1)
    assert quiesced.stop() == 0
    return quiesced.state / kept.file


@each_record
@pytest.mark.parametrize("damage", ["flipped", "cut"])
def test_damaged_record_is_told_and_not_used(quiesced: Quiesced, kept: Kept, damage: str) -> None:
    record = stored(quiesced, kept)
    data = record.read_bytes()
    flipped = bytes([*data[:100], data[100] ^ 1, *data[101:]])
    record.write_bytes(flipped if damage == "flipped" else data[: len(data) // 2])
    quiesced.start()
    host = TableHost(quiesced.peer)
    assert (host.info(kept.road, STORED_CRC), host.info(kept.road, RECORD)) == (0, LOST)
    if kept.words is not None:
        assert host.info(kept.road, CRC) == 0
    road = ("law", "tracker", "learnt")[kept.road]
    assert quiesced_status(quiesced)["tables"][road]["record"] == "lost"
    assert quiesced.stop() == 0
    assert f"{kept.name} is not used: " in quiesced.log_text()
    assert "damaged: " in quiesced.log_text()


@each_record
def test_half_of_a_new_record_leaves_the_old_one(quiesced: Quiesced, kept: Kept) -> None:
    """What a cut leaves while a record is stored."""
    record = stored(quiesced, kept)
    data = record.read_bytes()
    record.with_name(record.name + ".new").write_bytes(data[: len(data) // 2])
    quiesced.start()
    host = TableHost(quiesced.peer)
    crc = host.info(kept.road, STORED_CRC)
    assert (crc != 0, host.info(kept.road, RECORD)) == (True, WHOLE)
    assert host.info(kept.road, CRC) == crc
    if kept.words is not None:
        assert crc == kept.words[1]
        assert host.info(kept.road, SOURCE) == STORED
    assert host.ask("TABLE_SAVE", kept.road) == (DONE, 0)
    assert quiesced.stop() == 0
    assert "is not used" not in quiesced.log_text()


def test_store_that_fails_is_answered(quiesced: Quiesced) -> None:
    quiesced.write_config("law = 'fuzzy'\n")
    quiesced.start()
    host = TableHost(quiesced.peer)
    (words,) = others(host, 1)
    host.use(words)
    (quiesced.state / "law_table.bin").mkdir()
    assert host.ask("TABLE_SAVE", LAW)[0] == STORE_FAILED
    assert quiesced.stop() == 0
    assert "not saved: the law's table: " in quiesced.log_text()


def test_stored_table_waits_for_the_law_that_it_is_of(quiesced: Quiesced) -> None:
    """The law was applied, but not saved with its table."""
    quiesced.write_config("law = 'fuzzy'\n")
    quiesced.start()
    host = TableHost(quiesced.peer)
    set_parameter(quiesced.peer, "law", PHASE)
    (words,) = others(host, 1)
    host.use(words)
    assert host.ask("TABLE_SAVE", LAW) == (DONE, 0)
    restart(quiesced)
    assert host.info(LAW, SOURCE) == SHIPS
    assert host.info(LAW, REFUSAL) == VERDICT_MAGIC
    assert "the law's table (stored) waits: " in quiesced.log_text()
    set_parameter(quiesced.peer, "law", PHASE)
    assert (host.info(LAW, CRC), host.info(LAW, SOURCE)) == (words[1], STORED)
    assert host.info(LAW, REFUSAL) == 0
    assert quiesced.stop() == 0
    assert f"the law's table: pulses, CRC {words[1]:08x} (stored)" in quiesced.log_text()


def write_tables(quiesced: Quiesced, parameters: str, **files: bytes) -> None:
    """The configuration with files of tables beside it."""
    for road, data in files.items():
        (quiesced.folder / f"{road}.table").write_bytes(data)
    keys = "".join(f'{road} = "{road}.table"\n' for road in files)
    quiesced.write_config(parameters, more=f"[tables]\n{keys}")


def test_configured_tables_are_used_and_stored_ones_before_them(quiesced: Quiesced) -> None:
    write_tables(quiesced, FORCES, law=file_of(LINEAR), tracker=file_of(MAP))
    check = quiesced.run("--check")
    assert check.returncode == 0, check.stdout
    assert f"the law's table: linear, {len(LINEAR)} words, CRC {LINEAR[1]:08x}" in check.stdout
    quiesced.start()
    host = TableHost(quiesced.peer)
    for road, words in ((LAW, LINEAR), (TRACKER, MAP)):
        assert (host.info(road, CRC), host.info(road, SOURCE)) == (words[1], CONFIGURATION)

    stronger = table([*LINEAR[:-1], 4_000])
    host.use(stronger)
    assert host.ask("TABLE_SAVE", LAW) == (DONE, 0)
    restart(quiesced)
    assert (host.info(LAW, CRC), host.info(LAW, SOURCE)) == (stronger[1], STORED)
    assert host.info(TRACKER, SOURCE) == CONFIGURATION
    assert quiesced.stop() == 0

    weaker = table([*LINEAR[:-1], 1_000])  # who edits the configuration means it
    write_tables(quiesced, FORCES, law=file_of(weaker), tracker=file_of(MAP))
    assert "[tables] has changed since" in quiesced.run("--check").stdout
    quiesced.start()
    assert (host.info(LAW, CRC), host.info(LAW, SOURCE)) == (weaker[1], CONFIGURATION)
    assert host.info(LAW, WRITES) == 1
    assert quiesced.stop() == 0
    assert "the law's table as stored is not used: [tables] has changed" in quiesced.log_text()


def test_reload_uses_other_tables_while_it_runs(quiesced: Quiesced) -> None:
    write_tables(quiesced, FORCES, law=file_of(LINEAR), tracker=file_of(MAP))
    start_running(quiesced)
    peer, host = quiesced.peer, TableHost(quiesced.peer)
    stronger = table([*LINEAR[:-1], 4_000])
    after = peer.count()
    write_tables(quiesced, FORCES, law=file_of(stronger), tracker=file_of(MAP))
    quiesced.signal(signal.SIGHUP)
    quiesced.wait_log(f"the law's table: linear, CRC {stronger[1]:08x} (configuration)")
    assert host.info(LAW, CRC) == stronger[1]
    assert is_armed_since(quiesced, after)

    host.use(LINEAR)
    quiesced.signal(signal.SIGHUP)  # nothing was edited
    quiesced.wait_log("other live parameters", 2)
    assert host.info(LAW, CRC) == LINEAR[1]

    for data, why in (
        (b"", "not a table file"),
        (file_of(MAP), "a table of kind map is for tables.tracker"),
        (file_of(LINEAR, board=7), "made for board 0x00000007, and this is no board"),
        (file_of(table([*LINEAR[:3], 1000, *LINEAR[4:]])), "another tick_rate_Hz"),
    ):
        write_tables(quiesced, FORCES, law=data, tracker=file_of(MAP))
        quiesced.signal(signal.SIGHUP)
        quiesced.wait_log(why)
        check = quiesced.run("--check")
        assert check.returncode == 2
        assert check.stdout.count("\n") == 1
        assert f"{quiesced.config}: tables.law: " in check.stdout
        assert why in check.stdout
    assert quiesced.log_text().count("parameters and tables stay: tables.law: ") == 4
    assert host.info(LAW, CRC) == LINEAR[1]
    assert is_armed_since(quiesced, after)
    assert quiesced.stop() == 0


def test_configured_table_that_is_no_good_does_not_keep_it_from_starting(
    quiesced: Quiesced,
) -> None:
    write_tables(quiesced, "law = 'fuzzy'\n", law=b"QTF1 and nothing that follows from it")
    quiesced.start()
    host = TableHost(quiesced.peer)
    assert host.info(LAW, SOURCE) == SHIPS
    assert quiesced.stop() == 0
    assert "tables.law: " in quiesced.log_text()
    (quiesced.folder / "law.table").unlink()
    assert quiesced.run("--make-safe").returncode == 0
    quiesced.start()
    killed(quiesced)
    assert quiesced.run("--make-safe").returncode == 0  # it waits for the caretaker
    assert "its outputs are safe" in quiesced.log_text()


def test_what_was_learnt_is_stored_sent_and_put_back(quiesced: Quiesced) -> None:
    quiesced.write_config("law = 'phase'\n")
    quiesced.start()
    host = TableHost(quiesced.peer)
    assert host.ask("LEARNT_RESTORE", LEARNT)[0] == NOTHING_TO_SEND
    assert host.ask("TABLE_SAVE", LEARNT) == (DONE, 0)
    assert host.info(LEARNT, WRITES) == 1
    words = words_of(host.fetch(LEARNT))
    assert words[0] == int.from_bytes(b"QLT1", "little")
    assert host.ask("LEARNT_FORGET", LEARNT)[0] == DONE
    assert host.ask("LEARNT_RESTORE", LEARNT)[0] == DONE
    assert host.load(file_of(words), words[1]) == (DONE, 0)
    assert quiesced.stop() == 0
    quiesced.start()
    assert host.info(LEARNT, WRITES) >= 1
    assert quiesced.stop() == 0
    assert "what was learnt before is used" in quiesced.log_text()
