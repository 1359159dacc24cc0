"""QEMU itself: it never outlives its user, and what goes wrong is told in one line."""

import os
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from quiesce.base.errors import BenchFailure
from quiesce_vm.boots import Vm
from quiesce_vm.results import results_of

ROOT = Path(__file__).resolve().parents[3]
USER = """
import sys
from pathlib import Path
sys.path += sys.argv[3:]
from quiesce_vm.machine import Boot, Machine
with Machine(Boot(Path(sys.argv[1]), Path(sys.argv[2]), "timing.sh")) as machine:
    print(machine.process_id, flush=True)
    machine.wait_end()
"""


def test_emulator_dies_with_its_user(vm: Vm) -> None:
    folders = (ROOT / "tools/src", ROOT / "tests/system/vm")
    paths = (vm.parts.vmlinuz, vm.initramfs, *folders)
    command = [sys.executable, "-c", USER, *map(str, paths)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as user:
        assert user.stdout is not None
        emulator = os.pidfd_open(int(user.stdout.readline()))
        user.send_signal(signal.SIGKILL)
    ready, _, _ = select.select([emulator], [], [], 60)
    os.close(emulator)
    assert ready, "QEMU is still there"


def test_silent_guest_is_told_in_one_line(vm: Vm) -> None:
    with vm.boot("timing.sh") as machine:
        with pytest.raises(BenchFailure) as failure:
            machine.wait_line("NO SUCH LINE", timeout_s=0.01)
        assert "said nothing of the kind" in str(failure.value)
        assert "end of its console" in str(failure.value)
        with pytest.raises(BenchFailure, match="the guest hangs"):
            machine.wait_end(timeout_s=0.01)


def test_failing_script_is_told_with_its_last_words(vm: Vm) -> None:
    with vm.boot("no_such_script.sh") as machine:
        with pytest.raises(BenchFailure, match="the guest ended, without a line 'READY'"):
            machine.wait_line("READY")
        with pytest.raises(BenchFailure, match="script ended with 2"):
            results_of(machine.wait_end())
        assert "no_such_script.sh" in machine.tail()


def test_stopped_emulator_is_not_hung_up_with_its_starters(vm: Vm) -> None:
    with vm.boot("timing.sh") as machine:
        assert os.getpgid(machine.process_id) == machine.process_id


def test_killed_emulator_is_told(vm: Vm) -> None:
    with vm.boot("timing.sh") as machine:
        os.kill(machine.process_id, signal.SIGKILL)
        with pytest.raises(BenchFailure, match="QEMU was ended by signal 9"):
            machine.wait_line("READY")
