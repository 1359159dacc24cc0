"""The virtual machine's boots, one a session each; build_images has made what they need.

QUIESCE_BUILD names another folder with the builds; QUIESCE_VM_CPU_SHARE=0.25 holds the emulator to
a quarter of a core.
"""

from collections.abc import Iterator

import pytest
from quiesce.base.errors import BenchFailure, UsageError
from quiesce_vm import boots, cpu_share


def told(run, *arguments):
    """What the boot brings back; a boot that fails is told in one line."""
    try:
        return run(*arguments)
    except (UsageError, BenchFailure) as error:
        line = str(error)
    pytest.fail(line, pytrace=False)


def pytest_terminal_summary(terminalreporter) -> None:
    if cpu_share.total.wall_s:
        terminalreporter.write_line(cpu_share.total.line())


@pytest.fixture(scope="session")
def vm() -> Iterator[boots.Vm]:
    told(cpu_share.wanted)
    parts = told(boots.Parts.built)
    with boots.opened(parts) as opened:
        yield opened


@pytest.fixture(scope="session")
def bus(vm: boots.Vm) -> boots.BusRun:
    return told(boots.run_bus, vm)


@pytest.fixture(scope="session")
def timing(vm: boots.Vm) -> boots.TimingRun:
    return told(boots.run_timing, vm)


@pytest.fixture(scope="session")
def tables(vm: boots.Vm) -> boots.TablesRun:
    return told(boots.run_tables, vm)


@pytest.fixture(scope="session")
def faults(vm: boots.Vm) -> boots.FaultRun:
    return told(boots.run_faults, vm)
