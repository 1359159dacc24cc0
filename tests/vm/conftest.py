"""The virtual machine's boots, one a session each; tools/vm_images has made what they need.

QUIESCE_BUILD names another folder with the builds.
"""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/src"))

from quiesce.errors import UsageError  # noqa: E402
from quiesce.vm import boots  # noqa: E402


@pytest.fixture(scope="session")
def vm():
    try:
        with boots.opened() as opened:
            yield opened
    except UsageError as error:
        pytest.fail(str(error), pytrace=False)


@pytest.fixture(scope="session")
def bus(vm) -> boots.BusRun:
    return boots.run_bus(vm)


@pytest.fixture(scope="session")
def timing(vm) -> boots.TimingRun:
    return boots.run_timing(vm)


@pytest.fixture(scope="session")
def faults(vm) -> boots.FaultRun:
    return boots.run_faults(vm)
