"""What makes the virtual machine's tests independent of the host's speed, without a machine: the
serial line that holds the guest back, and the holder that slows an emulator down on purpose."""

import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from quiesce.base.errors import BenchFailure, UsageError
from quiesce_vm import cpu_share
from quiesce_vm.serial_line import SerialLine
from quiesce_vm.slow import main, told

WAIT_S = 60.0


@pytest.fixture
def ends(tmp_path: Path):
    """The line, and the emulator's end of it."""
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "line"))
        server.listen()
        line = SerialLine(tmp_path / "line")
        emulator, _ = server.accept()
        with emulator:
            yield line, emulator
        line.close()


def test_frames_that_come_in_pieces(ends) -> None:
    line, emulator = ends
    emulator.sendall(b"t0102AB")
    assert line.receive(0.0) is None
    emulator.sendall(b"CD\rt7FF0\r")
    first, second = line.receive(WAIT_S), line.receive(WAIT_S)
    assert (first.arbitration_id, bytes(first.data)) == (0x010, b"\xab\xcd")
    assert (second.arbitration_id, bytes(second.data)) == (0x7FF, b"")
    assert line.malformed == 0


@pytest.mark.parametrize("noise", [b"", b"t01", b"t010XAB", b"t0102ABC", b"\xff\x00", b"t" * 40])
def test_what_is_no_frame_is_counted(ends, noise: bytes) -> None:
    line, emulator = ends
    emulator.sendall(noise + b"\rt0100\r")
    assert line.receive(WAIT_S).arbitration_id == 0x010
    assert line.malformed == 1


def test_a_frame_is_sent_as_a_line(ends) -> None:
    line, emulator = ends
    line.send(0x02A, b"\x01\xff")
    assert emulator.recv(100) == b"t02A201ff\r"


def test_end_of_the_line(ends) -> None:
    line, emulator = ends
    emulator.sendall(b"t0100\r")
    emulator.close()
    assert line.receive(WAIT_S).arbitration_id == 0x010
    assert line.receive(WAIT_S) is None
    assert line.is_over
    with pytest.raises(BenchFailure, match="is gone"):
        line.send(0x010, b"")


def test_no_line_is_told(tmp_path: Path) -> None:
    with pytest.raises(BenchFailure, match="does not answer"):
        SerialLine(tmp_path / "no_such_line")


def test_a_slow_reader_holds_the_writer_back(ends) -> None:
    """An emulated UART writes byte by byte: not many frames are under way at once."""
    _, emulator = ends
    emulator.setblocking(False)
    written = 0
    with pytest.raises(BlockingIOError):
        while written < 2000:
            written += emulator.send(b"t")
    assert 1 <= written < 2000


def test_a_held_process_gets_its_share_and_no_more() -> None:
    usage = cpu_share.Usage()
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as busy:
        holder = cpu_share.Holder(busy.pid, 0.1, usage)
        time.sleep(3.0)
        holder.release()
        assert busy.poll() is None
        state = Path(f"/proc/{busy.pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
        busy.kill()
    assert usage.wall_s >= 2.9
    assert 0 < usage.cpu_s <= 0.1 * usage.wall_s + 0.1  # one look that came late
    assert state != "T"  # it goes on


def test_a_process_that_ends_is_let_go() -> None:
    with subprocess.Popen([sys.executable, "-c", ""]) as short:
        holder = cpu_share.Holder(short.pid, 0.5, cpu_share.Usage())
        short.wait(WAIT_S)
        holder.release()


def test_measured_share_is_read_back() -> None:
    usage = cpu_share.Usage(cpu_s=2.5, wall_s=10.0)
    assert usage.line() == "emulator: 0.250 of a core over 10.0 s"
    assert cpu_share.used_share(f"33 passed\n{usage.line()}\n") == 0.25
    assert cpu_share.used_share("33 passed") is None


def test_a_slow_run_tells_each_reason_once() -> None:
    errors = [f"ERROR tests/test_vm_bus.py::test_{name} - Failed: the guest ended" for name in "ab"]
    assert told("\n".join(["EE", *errors, "2 errors in 1.0s"])) == (
        "Failed: the guest ended | 2 errors in 1.0s"
    )
    assert told("..\n2 passed in 1.0s\n") == "2 passed in 1.0s"


@pytest.mark.parametrize("text", ["0", "-1", "1.5", "nan", "inf", "a quarter"])
def test_share_that_is_none_is_refused(monkeypatch, text: str) -> None:
    monkeypatch.setenv(cpu_share.VARIABLE, text)
    with pytest.raises(UsageError, match="expected a share of a core"):
        cpu_share.wanted()


def test_no_share_is_wanted_without_the_variable(monkeypatch) -> None:
    monkeypatch.delenv(cpu_share.VARIABLE, raising=False)
    assert cpu_share.wanted() is None


def test_slow_refuses_a_share_in_one_line(capsys) -> None:
    with pytest.raises(SystemExit) as exit_info:
        main(["--share", "2"])
    assert exit_info.value.code == 2
    assert "expected a share of a core" in capsys.readouterr().err.splitlines()[-1]
