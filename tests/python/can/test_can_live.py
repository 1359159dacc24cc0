"""The CAN tools beside a real controller: the firmware's node, SLCAN on a pseudo-terminal."""

import json
import os
import pty
import re
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import can
import pytest
from can_bus import Controller, build_peer, start_quiesce, wait_line
from conftest import ROOT, Result, run_quiesce
from quiesce.can import slcan
from quiesce.can.database import load
from quiesce.can.e2e import protect
from quiesce.can.parameters import parameters
from quiesce.can.readers import read_log
from quiesce.can.traffic import Traffic
from quiesce.cli.can.check import Trips, problems_of, row
from quiesce.cli.can.monitor import View
from quiesce.cli.main import main

DATABASE = load()
COUNT = len(parameters())


@pytest.fixture(scope="session")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("can_peer"))


@pytest.fixture
def controller(peer: Path, tmp_path: Path) -> Iterator[Controller]:
    one = Controller(peer, tmp_path)
    yield one
    one.stop()


@pytest.fixture
def tool(tmp_path: Path, controller: Controller):
    """Runs an action on the controller's bus."""

    def run(*arguments: str | Path) -> Result:
        return run_quiesce(tmp_path, "can", *arguments, "--bus", controller.bus)

    return run


def values(tool) -> dict[str, int]:
    result = tool("get", "--json")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def error_line(result: Result, code: int) -> str:
    """The one line of a failure."""
    assert result.returncode == code, result.stdout + result.stderr
    lines = result.stderr.splitlines()
    assert len(lines) == 1 and lines[0].startswith("quiesce: "), result.stderr
    return lines[0]


# Parameters


@pytest.mark.slow
def test_get_shows_every_parameter(controller: Controller, tool) -> None:
    controller.start()
    assert values(tool) == {one["name"]: one["default"] for one in parameters()}
    table = tool("get", "law")
    assert "fuzzy" in table.stdout and "rms_window_ms" not in table.stdout


def test_armed_controller_takes_live_parameters_only(controller: Controller, tool) -> None:
    controller.start()
    line = error_line(tool("set", "law=constant"), 1)
    assert "the controller is armed, and law may not change then; disarm it first" in line
    assert tool("set", "unlock_current_mA=4000").returncode == 0
    assert values(tool)["unlock_current_mA"] == 4000


def test_set_changes_all_or_nothing(controller: Controller, tool) -> None:
    controller.start("--idle")
    result = tool("set", "law=constant", "constant_current_mA=1500", "--save")
    assert result.returncode == 0, result.stderr
    assert "law: fuzzy -> constant" in result.stdout and "stored" in result.stderr
    before = values(tool)
    assert (before["law"], before["constant_current_mA"]) == (1, 1500)
    line = error_line(tool("set", "law=phase", "band_low_mHz=9000", "band_high_mHz=8000"), 1)
    assert "band_" in line and "2000 .. 50000" in line and "nothing was changed" in line
    assert values(tool) == before


@pytest.mark.slow
def test_set_says_where_it_could_not_be_stored(controller: Controller, tool) -> None:
    controller.start("--idle", "--no-store")
    result = tool("set", "law=off", "--save")
    assert result.returncode == 1 and "STORE_FAILED" in result.stderr
    assert values(tool)["law"] == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["law=nope"], "one of off, constant, fuzzy"),
        (["rms_window_ms=1"], "100 .. 4000"),
        (["colour=1"], "no parameter 'colour'"),
        (["law"], "NAME=VALUE"),
        (["law="], "law is one of"),
    ],
)
def test_set_refuses_before_it_sends(
    capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert main(["can", "set", *arguments, "--bus", "slcan:/nowhere"]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.slow
def test_nobody_answers(controller: Controller, tool) -> None:
    controller.start("--silent")
    assert "no controller answers" in error_line(tool("get"), 1)
    assert "no controller answers" in error_line(tool("set", "law=off"), 1)


# Another version of the messages


OTHER = "has version 4 of the CAN messages, these tools have 3"


@pytest.mark.slow
def test_other_messages_are_refused_before_anything_is_asked(controller: Controller, tool) -> None:
    controller.start("--interface", "4", "--idle")
    for action in (["get"], ["set", "law=off"], ["tables"], ["freeze"]):
        assert OTHER in error_line(tool(*action), 2), action
    result = tool("check", "--seconds", "1.5")
    assert result.returncode == 1 and OTHER in result.stdout
    # A stop is never held back by what might be misread.
    assert tool("stop", "--yes").returncode == 0


@pytest.mark.slow
def test_recording_of_other_messages_asks_nothing(
    controller: Controller, tool, tmp_path: Path
) -> None:
    controller.start("--interface", "4")
    result = tool("record", "--out", tmp_path / "a.log", "--raw", "--seconds", "2")
    assert result.returncode == 0, result.stderr
    assert OTHER in result.stderr and "no parameters" in result.stderr
    ids = {frame.arbitration_id for frame in read_log(tmp_path / "a.log")}
    assert DATABASE.by_name["Identification"].frame_id in ids
    assert not ids & {DATABASE.by_name[n].frame_id for n in ("ServiceRequest", "ServiceReply")}


# Emergency stop


def test_stop_is_confirmed_by_the_controller(controller: Controller, tool) -> None:
    controller.start()
    result = tool("stop", "--yes")
    assert result.returncode == 0, result.stderr
    assert result.stdout == "stopped: the controller reports state FAULT, fault ESTOP\n"
    assert "latched fault" in error_line(tool("set", "law=off"), 1)


def test_stop_does_not_wait_for_a_board(
    controller: Controller, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On lines of boards, whose pause would fail here: no such sleep exists."""
    controller.start()
    monkeypatch.setattr(slcan, "BOARDS", (str(controller.path),))
    monkeypatch.setattr(slcan, "RESET_S", -1.0)
    assert main(["can", "get", "law", "--bus", controller.bus]) == 2
    assert "cannot open" in capsys.readouterr().err
    assert main(["can", "stop", "--yes", "--bus", controller.bus]) == 0
    assert "fault ESTOP" in capsys.readouterr().out


def test_stop_says_where_it_is_not_confirmed(controller: Controller, tool) -> None:
    controller.start("--silent")
    assert "NOT CONFIRMED" in error_line(tool("stop", "--yes", "--timeout-s", "0.3"), 1)


def test_stop_asks_first(controller: Controller, tool, tmp_path: Path) -> None:
    controller.start()
    assert "--yes" in error_line(tool("stop"), 2)
    for answer, code in (("n", 1), ("", 1), ("y", 0)):
        master, slave = os.openpty()
        os.write(master, f"{answer}\n".encode())
        command = [sys.executable, "-m", "quiesce", "can", "stop", "--bus", controller.bus]
        env = {**os.environ, "PYTHONPATH": str(ROOT / "tools/src")}
        result = subprocess.run(command, stdin=slave, capture_output=True, text=True, env=env)
        os.close(master)
        os.close(slave)
        assert result.returncode == code and "[y/N]" in result.stderr


# check


def test_check_of_a_bus_in_order(controller: Controller, tool) -> None:
    """Nothing is lost and everything is answered; how fast is not judged on a busy machine."""
    controller.start()
    result = tool("check", "--seconds", "1.5", "--json")
    report = json.loads(result.stdout)
    assert (result.returncode == 0) == (report["problems"] == [])
    faults = ("lost", "wrong_crc", "wrong_length", "repeated", "unknown", "error_frames")
    assert {name: report[name] for name in faults} == dict.fromkeys(faults, 0)
    counts = {one["name"]: one["count"] for one in report["messages"]}
    assert counts["CurrentDemand"] > 0 and "Identification" in counts
    assert report["round_trip"]["answered"] > 0


@pytest.mark.parametrize(
    ("count", "is_on_time"), [(0, False), (88, False), (91, True), (110, True), (112, False)]
)
def test_check_judges_cycle_times(count: int, is_on_time: bool) -> None:
    """Status has 10 ms: 100 frames in a second, 10 % and one frame more or less."""
    traffic = Traffic(DATABASE)
    status = DATABASE.by_name["Status"]
    for i in range(count):
        data = protect(status.protection, i % 16, DATABASE.encode("Status"))
        message = can.Message(
            timestamp=i / 100.0, arbitration_id=0x100, is_extended_id=False, data=data
        )
        assert traffic.take(message) == "ok"
    judged = row(traffic, status, 1.0, 10.0)
    assert judged["count"] == count and judged["is_on_time"] == is_on_time
    problems = problems_of(traffic, Trips([1.0]), [judged])
    assert len(problems) == (not is_on_time)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--drop", "7"], "frames were lost"),
        (["--corrupt", "7"], "wrong CRC"),
        (["--silent"], "no controller answers"),
    ],
)
def test_check_finds_what_is_wrong(controller: Controller, tool, options, words: str) -> None:
    controller.start(*options)
    result = tool("check", "--seconds", "1")
    assert result.returncode == 1, result.stdout
    assert words in result.stdout and "FAILED" in result.stdout


# record


def check_preamble(frames: list[can.Message]) -> None:
    """Identification, then every parameter in order."""
    ids = [one.arbitration_id for one in frames[: COUNT + 1]]
    reply = DATABASE.by_name["ServiceReply"].frame_id
    assert ids == [DATABASE.by_name["Identification"].frame_id] + [reply] * COUNT
    raw = [DATABASE.raw(reply, bytes(one.data)) for one in frames[1 : COUNT + 1]]
    assert [one["param_index"] for one in raw] == list(range(COUNT))
    assert [one["param_value"] for one in raw] == [one["default"] for one in parameters()]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suffix", "number"),
    [
        (".log", signal.SIGINT),
        (".asc", signal.SIGTERM),
        (".blf", signal.SIGINT),
        (".csv", signal.SIGTERM),
        (".mf4", signal.SIGINT),
        (".mf4", signal.SIGTERM),
    ],
)
def test_record_is_whole_however_it_ends(
    controller: Controller, tmp_path: Path, suffix: str, number: int
) -> None:
    controller.start()
    arguments = ["--out", f"run{suffix}", "--rotate-s", "600", "--bus", controller.bus]
    process = start_quiesce(tmp_path, "can", "record", *arguments)
    wait_line(process.stderr, lambda line: "every file begins with" in line)
    process.send_signal(number)
    out, err = process.communicate()
    assert process.returncode == 0, err
    frames = list(read_log(tmp_path / f"run_0001{suffix}"))
    check_preamble(frames)
    assert out == f"run_0001{suffix}: {len(frames)} frames\n"
    assert sorted(tmp_path.glob("run*")) == [tmp_path / f"run_0001{suffix}"]


@pytest.mark.slow
def test_every_file_of_a_rotation_begins_with_the_parameters(
    controller: Controller, tool, tmp_path: Path
) -> None:
    controller.start()
    result = tool("record", "--out", "run.blf", "--seconds", "4", "--rotate-mb", "0.01")
    assert result.returncode == 0, result.stderr
    files = sorted(tmp_path.glob("run_*.blf"))
    assert len(files) >= 2
    total = 0
    for file in files:
        frames = list(read_log(file))
        check_preamble(frames)
        total += len(frames) - (COUNT + 1)
    # All that was received is in a file, the preamble of the first among it, and the requests.
    received = int(re.search(r"^(\d+) frames", result.stderr, re.MULTILINE)[1])
    requests = sum(one.arbitration_id == 0x400 for file in files for one in read_log(file))
    assert total - requests == received - (COUNT + 1)


@pytest.mark.slow
def test_mdf_carries_database_and_parameters(controller: Controller, tool, tmp_path: Path) -> None:
    from asammdf import MDF

    controller.start()
    assert tool("record", "--out", "run.mf4", "--seconds", "2").returncode == 0
    with MDF(tmp_path / "run.mf4") as mdf:
        assert mdf.extract_attachment(0)[0] == DATABASE.source.encode()
        dump = json.loads(mdf.extract_attachment(1)[0])
    assert dump["parameters"] == {one["name"]: one["default"] for one in parameters()}
    assert dump["identification"]["version_minor"] >= 0


@pytest.mark.slow
def test_record_of_every_sample(controller: Controller, tool, tmp_path: Path) -> None:
    controller.start()
    assert tool("record", "--out", "run.blf", "--seconds", "4", "--raw").returncode == 0
    raw = DATABASE.by_name["RawSample"].frame_id
    ticks = [
        DATABASE.raw(raw, bytes(one.data))["tick_low"]
        for one in read_log(tmp_path / "run.blf")
        if one.arbitration_id == raw
    ]
    assert len(ticks) > 100 and ticks == sorted(set(ticks))


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".log", ".blf", ".asc"])
def test_times_of_a_recording_never_step_back(
    controller: Controller, tool, tmp_path: Path, suffix: str
) -> None:
    controller.start()
    assert tool("record", "--out", f"run{suffix}", "--seconds", "4", "--raw").returncode == 0
    frames = list(read_log(tmp_path / f"run{suffix}"))
    request = DATABASE.by_name["ServiceRequest"].frame_id
    stamps_s = [one.timestamp for one in frames]
    assert stamps_s == sorted(stamps_s)
    assert sum(one.arbitration_id == request for one in frames) > COUNT


@pytest.mark.slow
def test_record_without_a_controller(controller: Controller, tool, tmp_path: Path) -> None:
    controller.start("--silent")
    result = tool("record", "--out", "run.log", "--seconds", "4")
    assert result.returncode == 0
    first = list(read_log(tmp_path / "run.log"))[:2]
    assert first[0].arbitration_id == DATABASE.by_name["Identification"].frame_id
    result = tool("record", "--out", "listen.log", "--seconds", "1", "--listen")
    assert result.returncode == 0
    assert all(one.arbitration_id != 0x400 for one in read_log(tmp_path / "listen.log"))


def frames_told(process: subprocess.Popen[str]) -> int:
    """Of the next progress."""
    line = wait_line(process.stderr, lambda line: " frames, " in line)
    return int(re.search(r"(\d+) frames, ", line)[1])


@pytest.mark.slow
def test_record_goes_on_after_the_bus_was_lost(controller: Controller, tmp_path: Path) -> None:
    controller.start()
    process = start_quiesce(tmp_path, "can", "record", "--out", "run.asc", "--bus", controller.bus)
    wait_line(process.stderr, lambda line: "every file begins with" in line)
    for _ in range(2):
        controller.stop()
        wait_line(process.stderr, lambda line: "bus lost" in line)
        controller.start()
        wait_line(process.stderr, lambda line: "bus back" in line)
    before = frames_told(process)
    while frames_told(process) == before:  # frames come again
        pass
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 0, err
    assert "0 wrong CRC" in err
    notes = [x for x in (tmp_path / "run.asc").read_text().splitlines() if x.startswith("//")]
    assert ["lost" in one for one in notes] == [True, False, True, False]
    frames = list(read_log(tmp_path / "run.asc"))
    check_preamble(frames)
    assert frames[-1].timestamp > float(notes[-1].split()[1]) - 0.1


def test_record_on_a_full_disk(controller: Controller, tmp_path: Path) -> None:
    controller.start()
    command = [sys.executable, "-m", "quiesce", "can", "record", "--out", "run.log"]
    result = subprocess.run(
        [*command, "--bus", controller.bus, "--seconds", "60"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools/src")},
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000)),
    )
    assert result.returncode == 1
    last = result.stderr.splitlines()[-1]
    assert last.startswith("quiesce: run.log: File too large; recording ended at"), result.stderr
    assert "Traceback" not in result.stderr
    frames = list(read_log(tmp_path / "run.log"))
    check_preamble(frames)
    assert len(frames) > 1000


def test_record_refuses_to_overwrite(refused, controller: Controller, tmp_path: Path) -> None:
    controller.start()
    (tmp_path / "run.log").write_text("mine")
    line = refused("can", "record", "--out", "run.log", "--bus", controller.bus)
    assert "run.log exists" in line and (tmp_path / "run.log").read_text() == "mine"
    line = refused("can", "record", "--out", "no/run.log", "--bus", controller.bus)
    assert "cannot write no/run.log" in line
    (tmp_path / "a.mf4.log").write_text("mine")
    line = refused("can", "record", "--out", "a.mf4", "--bus", controller.bus)
    assert "a.mf4.log exists" in line and (tmp_path / "a.mf4.log").read_text() == "mine"


@pytest.mark.parametrize("stale", ["run_0001.mf4", "run_0003.mf4", "run_0002.mf4.log"])
def test_record_refuses_a_series_that_is_there(refused, tmp_path: Path, stale: str) -> None:
    """Before it starts, not when it gets there."""
    (tmp_path / stale).write_text("mine")
    for other in ("run.mf4", "run_1.mf4", "run_0001.mf4.part", "xrun_0001.mf4"):
        (tmp_path / other).write_text("of another name")
    rotating = ["--out", "run.mf4", "--rotate-s", "600", "--seconds", "1"]
    assert f"{stale} exists" in refused("can", "record", *rotating, "--bus", "virtual:x")
    assert (tmp_path / stale).read_text() == "mine"


# monitor


@pytest.mark.slow
def test_monitor_shows_loss_and_return(controller: Controller, tmp_path: Path) -> None:
    controller.start()
    process = start_quiesce(tmp_path, "can", "monitor", "--bus", controller.bus)
    line = wait_line(process.stdout, lambda line: " RUN " in line and " Hz " in line)
    assert "fault NONE" in line and "bus ok" in line
    controller.stop()
    wait_line(process.stdout, lambda line: "BUS LOST" in line)
    controller.start()
    wait_line(process.stdout, lambda line: "bus ok" in line)
    process.send_signal(signal.SIGTERM)
    out, err = process.communicate()
    assert process.returncode == 0 and err == ""


def test_monitor_draws_a_table_on_a_terminal(controller: Controller, tmp_path: Path) -> None:
    controller.start()
    pid, master = pty.fork()
    if pid == 0:
        os.environ["PYTHONPATH"] = str(ROOT / "tools/src")
        command = ["-m", "quiesce", "can", "monitor", "--bus", controller.bus]
        os.execv(sys.executable, [sys.executable, *command])
    seen = b""
    while b"SpectrumPeak2" not in seen or b"8.0" not in seen:
        seen += os.read(master, 4096)
    os.kill(pid, signal.SIGINT)
    try:
        while os.read(master, 4096):
            pass
    except OSError:  # the terminal is closed
        pass
    assert os.waitpid(pid, 0)[1] == 0
    os.close(master)
    assert b"\x1b[H\x1b[J" in seen and b"state      RUN, fault NONE" in seen


def test_monitor_shows_how_the_ticks_come() -> None:
    view = View(SimpleNamespace(bus=SimpleNamespace(name="a bus"), malformed=0), DATABASE)

    def take(name: str, **signals: int) -> None:
        number = DATABASE.by_name[name].frame_id
        data = DATABASE.encode(name, **signals)
        frame = can.Message(timestamp=1.0, arbitration_id=number, is_extended_id=False, data=data)
        view.take(frame)

    assert "ticks      - lost" in view.table(1.0) and "processor" not in view.table(1.0)
    take("LoopTiming", overruns=3, lateness_max_us=41, work_max_us=310)
    assert "3 lost, at most 41 us late and 310 us of work in the last second" in view.table(1.0)
    take("LoopCycles", work_max_cycles=52000, interrupt_max_cycles=700, core_kHz=168000)
    assert (
        "processor  52000 cycles a tick and 700 an interrupt of the current loop at most, "
        "of 168 MHz" in view.table(1.0)
    )


def test_monitor_shows_what_was_shed() -> None:
    view = View(SimpleNamespace(bus=SimpleNamespace(name="a bus"), malformed=0), DATABASE)
    assert "not sent   - demands, - answers, - telemetry" in view.table(1.0)
    data = DATABASE.encode("CanShed", unsent_demands=3, unsent_answers=2, unsent_telemetry=70001)
    view.take(can.Message(timestamp=1.0, arbitration_id=0x133, is_extended_id=False, data=data))
    assert "not sent   3 demands, 2 answers, 70001 telemetry" in view.table(1.0)
    assert " shed 70001 bus " in view.line(1.0)


# Options


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["monitor"], "which bus?"),
        (["monitor", "--bus", "can0"], "INTERFACE:CHANNEL"),
        (["monitor", "--bus", "socketcan:"], "INTERFACE:CHANNEL"),
        (["monitor", "--bus", "telepathy:1"], "no interface 'telepathy'"),
        (["monitor", "--bus", "slcan:/no/such/tty"], "cannot open slcan:/no/such/tty"),
        (["monitor", "--bus", "slcan:socket://127.0.0.1:1"], "cannot open slcan:socket"),
        (["monitor", "--bus", "pcan:PCAN_USBBUS1"], "cannot open pcan"),
        (["monitor", "--bus", "slcan:/dev/null", "--bitrate", "-5"], "--bitrate"),
        (["monitor", "--bus", "slcan:/dev/null", "--bus-option", "x"], "KEY=VALUE"),
        (["monitor", "--bus", "slcan:/dev/null", "--seconds", "0"], "--seconds"),
        (["record", "--out", "a.db", "--bus", "virtual:x"], ".mf4"),
        (["record", "--out", "a.log", "--bus", "virtual:x", "--raw", "--listen"], "--listen"),
        (["record", "--out", "a.log", "--bus", "virtual:x", "--rotate-mb", "0"], "--rotate-mb"),
        (["record", "--out", "a.log", "--bus", "virtual:x", "--rotate-s", "nan"], "--rotate-s"),
        (["check", "--bus", "virtual:x", "--tolerance", "0"], "--tolerance"),
        (["stop", "--yes", "--bus", "virtual:x", "--timeout-s", "-1"], "--timeout-s"),
        (["replay", "no.log", "--bus", "virtual:x"], "no.log"),
        (["replay", "no.log", "--bus", "virtual:x", "--speed", "0"], "--speed"),
        (["get", "colour", "--bus", "virtual:x"], "no parameter has 'colour'"),
        (["get", "--bus", "virtual:x", "--dbc", "y"], "--dbc"),
        (["nothing"], "nothing"),
    ],
)
def test_bad_options(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    words: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["can", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == "" and len(err.splitlines()) == 1 and words in err
    assert list(tmp_path.iterdir()) == []


def test_packages_are_loaded_by_the_actions_that_need_them(tmp_path: Path) -> None:
    code = "import sys, quiesce.cli; print({'can', 'cantools', 'asammdf'} & set(sys.modules))"
    env = {**os.environ, "PYTHONPATH": str(ROOT / "tools/src")}
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=env)
    assert result.stdout == "set()\n", result.stderr


def test_an_absent_package_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "cantools", None)
    load.cache_clear()
    try:
        assert main(["can", "bus-load"]) == 2
    finally:
        load.cache_clear()
    assert "package cantools is not installed" in capsys.readouterr().err


@pytest.mark.slow
def test_list_says_why(quiesce) -> None:
    result = quiesce("can", "list", "--json")
    assert result.returncode == 0
    found = {one["interface"]: one for one in json.loads(result.stdout)}
    assert set(found) >= {"socketcan", "slcan", "udp_multicast", "pcan", "vector"}
    assert all(one["note"] for one in found.values())


@pytest.mark.parametrize(
    "action",
    [
        "list",
        "decode",
        "monitor",
        "check",
        "record",
        "replay",
        "get",
        "set",
        "stop",
        "freeze",
        "load",
        "tables",
        "revert",
        "fetch",
        "save-learnt",
        "restore-learnt",
        "forget-learnt",
        "bus-load",
    ],
)
def test_every_action_has_help_with_examples(
    capsys: pytest.CaptureFixture[str], action: str
) -> None:
    assert main(["can", action, "--help"]) == 0
    out = capsys.readouterr().out
    assert f"quiesce can {action}" in out and "example" in out
