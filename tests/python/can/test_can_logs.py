"""CAN logs: every format there and back, what is malformed or cut off, what the disk refuses."""

import csv
import io
import json
import random
import shutil
import subprocess
import sys
from pathlib import Path

import can
import pytest
from can.util import CAN_FD_DLC
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.can.buses import Bus
from quiesce.can.database import load
from quiesce.can.e2e import protect
from quiesce.can.link import Link
from quiesce.can.readers import read_log
from quiesce.can.recorder import Plan, Recorder, open_first
from quiesce.can.writers import FORMATS, MdfFile, open_log

DATABASE = load()
START_S = 1_700_000_000.25
TRC = """;$FILEVERSION=2.1
;$STARTTIME=45000.5
;$COLUMNS=N,O,T,B,I,d,R,L,D
      1       100.000 DT  1     0100 Rx -  8    01 02 03 04 05 06 07 08
      2       110.500 DT  1     0010 Rx -  4    01 02 03 04
"""


def status(alive: int, rms_um_s2: int = 1_000_000) -> bytes:
    data = DATABASE.encode("Status", state=2, rms_um_s2=rms_um_s2)
    layout = DATABASE.by_name["Status"].protection
    assert layout is not None
    return protect(layout, alive % 16, data)


def frame(index: int, data: bytes | None = None, frame_id: int = 0x100) -> can.Message:
    return can.Message(
        timestamp=START_S + 0.01 * index,
        arbitration_id=frame_id,
        is_extended_id=frame_id > 0x7FF,
        data=status(index) if data is None else data,
        channel=0,
    )


def attachments() -> list[tuple[str, bytes, str]]:
    dump = b'{"parameters": {}}'
    return [
        ("quiesce.dbc", DATABASE.source.encode(), "application/octet-stream"),
        ("parameters.json", dump, "application/json"),
    ]


def write(path: Path, frames: list[can.Message]) -> Path:
    log = open_log(path, attachments)
    for one in frames:
        log.write(one)
    log.close()
    if isinstance(log, MdfFile):
        log.finish()
        assert log.failure == ""
    return path


def several(count: int = 500) -> list[can.Message]:
    """Standard and extended ids, every length."""
    rng = random.Random(5)
    ids = (0x010, 0x100, 0x7FF, 0x18FF1234)
    return [frame(i, rng.randbytes(rng.randint(0, 8)), rng.choice(ids)) for i in range(count)]


@pytest.mark.parametrize("suffix", FORMATS)
def test_frames_survive_the_way_through_a_file(tmp_path: Path, suffix: str) -> None:
    frames = several()
    back = list(read_log(write(tmp_path / f"a{suffix}", frames)))
    assert len(back) == len(frames)
    for one, other in zip(frames, back, strict=True):
        assert (one.arbitration_id, one.is_extended_id) == (
            other.arbitration_id,
            other.is_extended_id,
        )
        assert bytes(one.data) == bytes(other.data)
        assert other.timestamp == pytest.approx(
            one.timestamp, abs=1e-3 if suffix == ".asc" else 2e-6
        )
    assert sorted(tmp_path.iterdir()) == [tmp_path / f"a{suffix}"]


@pytest.mark.parametrize("suffix", FORMATS)
def test_python_can_reads_what_we_write(tmp_path: Path, suffix: str) -> None:
    path = write(tmp_path / f"a{suffix}", several())
    with can.LogReader(path) as reader:
        assert [bytes(one.data) for one in reader] == [bytes(one.data) for one in several()]


def test_mdf_is_decoded_by_asammdf_with_its_own_attachment(tmp_path: Path) -> None:
    from asammdf import MDF

    values = [1000 * i for i in range(300)]
    path = write(tmp_path / "a.mf4", [frame(i, status(i, v)) for i, v in enumerate(values)])
    with MDF(path) as mdf:
        content, name, _ = mdf.extract_attachment(0)
        names = [str(name)] + [str(mdf.extract_attachment(i)[1]) for i in range(1, 2)]
        assert content == DATABASE.source.encode()
        assert [Path(one).name for one in names] == ["quiesce.dbc", "parameters.json"]
        (tmp_path / "of_the_log.dbc").write_bytes(content)
        decoded = mdf.extract_bus_logging({"CAN": [(tmp_path / "of_the_log.dbc", 0)]})
        signal = decoded.get("rms_um_s2")
        assert signal.samples.tolist() == values and signal.unit == "um/s2"
        assert signal.timestamps[-1] - signal.timestamps[0] == pytest.approx(2.99, abs=1e-5)


def test_mdf_larger_than_a_chunk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from quiesce.can import mdf

    monkeypatch.setattr(mdf, "CHUNK", 100)
    frames = several(450)
    mdf.write_mdf(tmp_path / "a.mf4", frames, attachments(), "")
    back = list(read_log(tmp_path / "a.mf4"))
    assert [bytes(one.data) for one in back] == [bytes(one.data) for one in frames]


@pytest.mark.parametrize("suffix", FORMATS)
def test_an_empty_recording_is_a_file(tmp_path: Path, suffix: str) -> None:
    path = write(tmp_path / f"a{suffix}", [])
    if path.stat().st_size:  # a candump log has no header
        assert list(read_log(path)) == []


def test_notes_are_where_the_format_has_a_place(tmp_path: Path) -> None:
    for suffix in FORMATS:
        log = open_log(tmp_path / f"a{suffix}", attachments)
        for i in range(20):
            log.write(frame(i))
            if i == 9:
                log.note("bus lost:\nÄ gap", START_S + 0.095)
        log.close()
        if isinstance(log, MdfFile):
            log.finish()
        assert len(list(read_log(tmp_path / f"a{suffix}"))) == 20
    assert "// 1700000000.345000 bus lost: Ä gap\n" in (tmp_path / "a.asc").read_text()

    from asammdf import MDF

    with MDF(tmp_path / "a.mf4") as mdf:
        assert "bus lost: Ä gap" in mdf.header.comment


def test_candump_logs_are_those_of_can_utils(tmp_path: Path) -> None:
    """No marks of direction, which Wireshark does not take; can-utils make an ASC log of it."""
    path = write(tmp_path / "a.log", [frame(0), frame(1, b"\xab", 0x18FF1234)])
    first, second = path.read_text().splitlines()
    assert first == f"(1700000000.250000) can0 100#{status(0).hex().upper()}"
    assert second == "(1700000000.260000) can0 18FF1234#AB"
    assert [one.arbitration_id for one in asc_of(path)] == [0x100, 0x18FF1234]


def asc_of(log: Path) -> list[can.Message]:
    """What can-utils make of a candump log."""
    if shutil.which("log2asc") is None:
        pytest.skip("log2asc is missing: Debian package can-utils (./tools/setup test)")
    asc = log.with_suffix(".asc")
    subprocess.run(["log2asc", "-I", log, "-O", asc, "can0"], check=True)
    return list(read_log(asc))


# CAN FD, remote and error frames


def fd_frame(index: int, length: int, fast: bool = True, passive: bool = False) -> can.Message:
    message = frame(index, bytes(range(1, length + 1)), 0x18FF1234 if index % 3 == 2 else 0x108)
    message.is_fd, message.bitrate_switch = True, fast
    message.error_state_indicator = passive
    return message


def fd_frames() -> list[can.Message]:
    """Every length, 8 bytes and fewer too, with every mark, between classic frames."""
    frames: list[can.Message] = []
    for length in CAN_FD_DLC:
        for fast, passive in ((True, False), (False, False), (True, True), (False, True)):
            frames += [fd_frame(len(frames), length, fast, passive), frame(len(frames) + 1)]
    return frames


def shape(one: can.Message) -> tuple[object, ...]:
    marks = (one.is_fd, one.bitrate_switch, one.error_state_indicator)
    return (one.arbitration_id, one.is_extended_id, *marks, bytes(one.data))


FD_FORMATS = [one for one in FORMATS if one != ".csv"]


@pytest.mark.parametrize("suffix", FD_FORMATS)
def test_fd_frames_survive_the_way_through_a_file(tmp_path: Path, suffix: str) -> None:
    path = write(tmp_path / f"a{suffix}", fd_frames())
    assert [shape(one) for one in read_log(path)] == [shape(one) for one in fd_frames()]
    with can.LogReader(path) as reader:
        theirs = [(one.arbitration_id, one.is_fd, bytes(one.data)) for one in reader]
    assert theirs == [(one.arbitration_id, one.is_fd, bytes(one.data)) for one in fd_frames()]


def test_candump_logs_of_fd_and_remote_frames_are_those_of_can_utils(tmp_path: Path) -> None:
    remote = can.Message(
        timestamp=START_S, arbitration_id=0x123, is_extended_id=False, is_remote_frame=True, dlc=8
    )
    path = write(tmp_path / "a.log", [fd_frame(0, 12), fd_frame(1, 8, False, True), remote])
    lines = [one.split()[2] for one in path.read_text().splitlines()]
    assert lines == ["108##10102030405060708090A0B0C", "108##20102030405060708", "123#R8"]
    frames = asc_of(path)
    assert [one.is_fd for one in frames] == [True, True, False]
    assert [len(one.data) for one in frames] == [12, 8, 0]


def test_csv_leaves_fd_frames_out_and_says_so(tmp_path: Path) -> None:
    log = open_log(tmp_path / "a.csv", attachments)
    for one in (frame(0), fd_frame(1, 8), fd_frame(2, 12), frame(3)):
        log.write(one)
    log.close()
    assert "cannot hold CAN FD frames, 2 left out" in log.failure and "\n" not in log.failure
    assert [shape(one) for one in read_log(log.path)] == [shape(frame(0)), shape(frame(3))]


@pytest.mark.parametrize("kind", ["is_remote_frame", "is_error_frame"])
def test_an_mdf_that_lacks_frames_keeps_the_log_that_has_them(tmp_path: Path, kind: str) -> None:
    log = open_log(tmp_path / "a.mf4", attachments)
    assert isinstance(log, MdfFile)
    odd = can.Message(timestamp=START_S + 0.01, arbitration_id=0, is_extended_id=False)
    setattr(odd, kind, True)
    for one in (frame(0), odd, fd_frame(2, 12)):
        log.write(one)
    log.close()
    log.finish()
    assert "1 remote or error frames are not in it" in log.failure and log.result == log.target
    wanted = [shape(frame(0)), shape(fd_frame(2, 12))]
    assert [shape(one) for one in read_log(tmp_path / "a.mf4")] == wanted
    kept = list(read_log(tmp_path / "a.mf4.log"))
    assert len(kept) == 3 and getattr(kept[1], kind)


# Recordings of a bus without a controller, python-can's virtual one


def recorded(plan: Plan, frames: list[can.Message], said: list[str]) -> Recorder:
    """A step of the recorder for each frame."""
    with (
        Link(Bus("virtual", str(plan.out), None, ())) as link,
        can.Bus(interface="virtual", channel=str(plan.out)) as other,
    ):
        recorder = Recorder(link, DATABASE, plan, said.append)
        open_first(recorder)
        for number, one in enumerate(frames, 1):
            other.send(one)
            while recorder.traffic.frames < number:
                recorder.step()
        recorder.close()
    return recorder


def test_recording_fd_frames_into_csv_is_told_at_once(tmp_path: Path) -> None:
    said: list[str] = []
    plan = Plan(tmp_path / "a.csv", None, None, False)
    recorder = recorded(plan, [frame(0), fd_frame(1, 12), fd_frame(2, 8), frame(3)], said)
    assert len(list(read_log(plan.out))) == recorder.file.frames == 2
    first, last = said
    assert "1 left out" in first and "2 left out" in last


def test_recording_goes_past_a_file_that_appears(tmp_path: Path) -> None:
    plan = Plan(tmp_path / "a.log", 1, None, False)

    class Others(list[can.Message]):
        """Another program makes the files of the next numbers once the recording has begun."""

        def __iter__(self):
            (tmp_path / "a_0002.log").write_text("theirs")
            (tmp_path / "a_0003.log").write_text("theirs")
            yield from super().__iter__()

    recorder = recorded(plan, Others(frame(i) for i in range(3)), [])
    assert [one.path.name for one in recorder.files] == [
        f"a_{number:04d}.log" for number in (1, 4, 5, 6)
    ]
    assert [one.frames for one in recorder.files] == [1, 1, 1, 0]
    assert {(tmp_path / f"a_000{i}.log").read_text() for i in (2, 3)} == {"theirs"}


def test_trc_of_other_tools_is_read(tmp_path: Path) -> None:
    (tmp_path / "a.trc").write_text(TRC)
    assert [one.arbitration_id for one in read_log(tmp_path / "a.trc")] == [0x100, 0x010]


# Malformed logs

CANDUMP = "(1.5) can0 100#0102030405060708 R\n"
CSV = "timestamp,arbitration_id,extended,remote,error,dlc,data\n"
ASC = "date Tue Nov 14 22:13:20.250 2023\nbase hex  timestamps absolute\ninternal events logged\n"


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.log", "", "empty"),
        ("a.log", "hello\n", "line 1: expected '(SECONDS) CHANNEL ID#DATA'"),
        ("a.log", CANDUMP + "(1.6) can0 100#01020\n", "line 2"),
        ("a.log", CANDUMP + "(1.6) can0 100#0102030405", "ok"),
        ("a.log", CANDUMP + "(1.6) can", "line 2"),
        ("a.log", CANDUMP + "(x) can0 100#01\n", "line 2"),
        ("a.log", CANDUMP + "(1.6) can0 FFF#01\n", "line 2"),
        ("a.log", CANDUMP + "(nan) can0 100#01\n", "line 2"),
        ("a.log", CANDUMP + "(1.6) can0 100#010203040506070809\n", "line 2"),
        ("a.log", CANDUMP + "(1.6) can0 100##1010203040506070809\n", "line 2"),
        ("a.log", CANDUMP + "(1.6) can0 100##\n", "line 2"),
        ("a.log", CANDUMP + "(1.6) can0 100##X01\n", "line 2"),
        ("a.log", CANDUMP + "(1.6) can0 100##1" + "00" * 65 + "\n", "line 2"),
        ("a.csv", "time,id\n1,2\n", "expected the columns"),
        ("a.csv", CSV + "1.5,0x100,0,0,0,8,AQID\n", "line 2"),
        ("a.csv", CSV + "1.5,0x100,0,0,0,3,AQ", "line 2"),
        ("a.csv", CSV + "1.5,0x100\n", "line 2"),
        ("a.asc", "nonsense\n", "not an ASC log"),
        ("a.asc", ASC + " 0.1 1  100 Rx d 8 01 02 03\n", "line 4"),
        ("a.asc", ASC + " 0.1 1  XYZ Rx d 1 01\n", "line 4"),
        ("a.asc", "date Tue never\n" + ASC, "not an ASC log"),
        ("a.trc", "nonsense\n", "not a TRC log"),
        ("a.trc", TRC.replace("01 02 03 04\n", "01 02"), "not a TRC log"),
        ("a.trc", TRC.replace("4    01 02 03 04\n", ""), "not a TRC log"),
        ("a.blf", "LOGG", "not a BLF log"),
        ("a.mf4", "MDF     4.10", "not an MDF4 log"),
        ("a.mf4", "nonsense" * 100, "not an MDF4 log"),
        ("a.db", "x", "unknown kind of log"),
        ("a", "x", "unknown kind of log"),
    ],
)
def test_malformed_logs(tmp_path: Path, name: str, content: str, words: str) -> None:
    (tmp_path / name).write_text(content)
    if words == "ok":  # cut off where a shorter frame remains: nobody can tell
        assert len(list(read_log(tmp_path / name))) == 2
        return
    with pytest.raises(UsageError, match=".") as caught:
        list(read_log(tmp_path / name))
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("suffix", FORMATS)
def test_cut_off_and_damaged_logs_end_in_one_line(tmp_path: Path, suffix: str) -> None:
    """Any prefix, and any damage: frames, or one clear line; never another exception."""
    whole = write(tmp_path / f"whole{suffix}", several(120)).read_bytes()
    rng = random.Random(11)
    refused = 0
    for _ in range(60):
        data = bytearray(whole[: rng.randrange(1, len(whole))])
        for _ in range(rng.choice((0, 0, 1, 8))):
            data[rng.randrange(len(data))] = rng.randrange(256)
        path = tmp_path / f"part{suffix}"
        path.write_bytes(data)
        try:
            list(read_log(path))
        except UsageError as error:
            refused += 1
            assert str(error).startswith(str(path)) and "\n" not in str(error)
    assert refused > 5


@pytest.mark.parametrize("suffix", [".blf", ".mf4"])
def test_binary_logs_that_are_cut_off_are_refused(tmp_path: Path, suffix: str) -> None:
    path = write(tmp_path / f"a{suffix}", several(2000))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UsageError):
        list(read_log(path))


# decode


def log_with_faults(path: Path) -> Path:
    frames = [frame(i) for i in range(20)]
    frames[4].data[2] ^= 1  # wrong CRC, and counted as lost by the next one
    del frames[10:12]  # lost
    frames[15] = frame(16, frames[14].data)  # repeated, and one lost
    frames.append(frame(30, b"\1\2", 0x123))
    frames.append(frame(31, b"\1\2", 0x108))
    return write(path, frames)


def test_decode_reports_what_is_wrong(quiesce, tmp_path: Path) -> None:
    result = quiesce("can", "decode", log_with_faults(tmp_path / "a.log"))
    assert result.returncode == 1
    assert "1 of unknown ids (0x123), 1 wrong CRC, 1 wrong length, 4 lost" in result.stderr
    assert "1 repeated" in result.stderr
    lines = result.stdout.splitlines()
    assert len(lines) == 19 and "[crc]" in lines[4] and "[repeated]" in result.stdout
    assert "state=RUN" in lines[0] and "rms_um_s2=1000000" in lines[0]


def test_decode_to_csv_and_json_lines(quiesce, tmp_path: Path) -> None:
    path = write(tmp_path / "a.blf", [frame(i) for i in range(3)] + [frame(3, bytes(8), 0x108)])
    rows = list(csv.DictReader(io.StringIO(quiesce("can", "decode", path, "--to", "csv").stdout)))
    assert {row["message"] for row in rows} == {"Status", "Motion"}
    assert [r["value"] for r in rows if r["signal"] == "rms_um_s2"] == ["1000000"] * 3
    assert {r["unit"] for r in rows if r["signal"] == "rms_um_s2"} == {"um/s2"}
    text = quiesce("can", "decode", path, "--to", "jsonl", "--only", "0x108").stdout
    (row,) = [json.loads(line) for line in text.splitlines()]
    assert row["message"] == "Motion" and row["signals"]["freq_uHz"] == 0


def test_decode_prints_what_comes_before_the_fault(quiesce, tmp_path: Path) -> None:
    path = write(tmp_path / "a.log", [frame(i) for i in range(5)])
    with path.open("a") as file:
        file.write("(1700000001.0) can0 100#01")
    with path.open("a") as file:
        file.write("X\n")
    result = quiesce("can", "decode", path)
    assert result.returncode == 2 and len(result.stdout.splitlines()) == 5
    assert "line 6" in result.stderr and "Traceback" not in result.stderr


def test_decode_of_pages(quiesce, tmp_path: Path) -> None:
    pages = [bytes([page, 10, 2, 0, 1, 0, 0, 0]) for page in (0, 5, 9)]
    path = write(tmp_path / "a.log", [frame(i, page, 0x120) for i, page in enumerate(pages)])
    result = quiesce("can", "decode", path)
    assert result.returncode == 0, result.stderr
    first, second, third = result.stdout.splitlines()
    assert "freeze_fault=ESTOP" in first and "freeze_displacement_amp_nm" in second
    assert third.endswith("FaultFreeze")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["none.log"], "No such file"),
        (["a.txt"], "unknown kind of log"),
        (["a.log", "--only", "Nothing"], "no such message"),
        (["a.log", "--to", "xml"], "--to"),
        ([], "FILE"),
    ],
)
def test_decode_refuses(refused, tmp_path: Path, arguments: list[str], words: str) -> None:
    (tmp_path / "a.txt").write_text("x")
    write(tmp_path / "a.log", [])
    assert words in refused("can", "decode", *arguments)


# A disk that takes no more

LIMITED = """
import resource, signal, sys
sys.path[:0] = [{root!r} + "/tools/src", {root!r} + "/tests/python", {root!r} + "/tests/python/can"]
from pathlib import Path
from quiesce.can.writers import open_log
import test_can_logs as logs
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
log = open_log(Path({path!r}), logs.attachments)
for i in range(20000):
    log.write(logs.frame(i))
    if log.error:
        break
log.close()
print(log.error.strerror)
"""


@pytest.mark.parametrize(
    ("suffix", "limit"),
    [(".log", 150_000), (".asc", 150_000), (".blf", 100_000), (".csv", 150_000)],
)
def test_what_a_full_disk_took_is_readable(tmp_path: Path, suffix: str, limit: int) -> None:
    path = tmp_path / f"a{suffix}"
    code = LIMITED.format(root=str(ROOT), limit=limit, path=str(path))
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.stdout == "File too large\n", result.stderr
    back = list(read_log(path))
    assert len(back) > 1000
    assert [bytes(one.data) for one in back] == [status(i) for i in range(len(back))]


def test_an_mdf_that_does_not_fit_leaves_its_frames(tmp_path: Path) -> None:
    log = open_log(tmp_path / "a.mf4", attachments)
    assert isinstance(log, MdfFile)
    log.write(frame(0))
    (tmp_path / "a.mf4.part.mf4").mkdir()  # what the MDF4 file would be written to
    log.close()
    log.finish()
    assert "a.mf4" in log.failure and "a.mf4.log" in log.failure
    assert len(list(read_log(tmp_path / "a.mf4.log"))) == 1
    assert not (tmp_path / "a.mf4").exists()
