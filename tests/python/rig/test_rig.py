"""quiesce.rig against the rig in the computer: variables, captures, stimuli, what is refused."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import quiesce.rig
from conftest import ROOT
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.rig import Rig, RigSetup, Trigger
from quiesce.rig.capture import Capture
from quiesce.rig.simulation import Simulation, own_bus
from quiesce_benchmarks.live.rig import PATIENCE_S

RESONANCE_Hz = 11.5
PULSED_Hz = 8.0  # below the resonance, at which law phase comes to a current that never falls


@pytest.fixture(scope="module")
def rig() -> Iterator[Rig]:
    with quiesce.rig.open("host") as one:
        one.wait(Trigger("status/state", equal="RUN"), PATIENCE_S)
        yield one


def test_variables_have_paths_and_units(rig: Rig) -> None:
    units = {one.path: one.unit for one in rig.variables()}
    assert units["status/rms_um_s2"] == "um/s2"
    assert units["parameters/tick_rate_Hz"] == "Hz"
    assert units["rig/vibration/now/displacement_um"] == "um"
    assert len(units) == len(rig.variables())
    assert not any(path.endswith(("/crc", "/alive")) for path in units)


@pytest.mark.slow
def test_parameters_are_written_and_read(rig: Rig) -> None:
    rig.write("rig/control", False)
    rig.wait(Trigger("status/is_enabled", equal=0), PATIENCE_S)
    rig.write("parameters/law", "constant")
    assert rig.read("parameters/law") == "constant"
    rig.write("parameters/law", "phase")
    assert rig.read("parameters/law") == "phase"
    rig.write("rig/control", True)
    rig.wait(Trigger("status/state", equal="RUN"), PATIENCE_S)


def test_a_stimulus_is_in_what_is_read_after_it(rig: Rig) -> None:
    rig.stimulus("sine", freq_Hz=RESONANCE_Hz, drive_V=0.02)
    assert rig.read("rig/freq_Hz") == RESONANCE_Hz
    assert rig.read("rig/drive_V") == 0.02
    rig.wait(
        Trigger(
            "motion/freq_uHz", above=1e6 * (RESONANCE_Hz - 0.2), below=1e6 * (RESONANCE_Hz + 0.2)
        ),
        PATIENCE_S,
    )


def test_a_capture_begins_before_its_trigger(rig: Rig) -> None:
    """Of pulses that come again and again: nothing has to happen in time."""
    rig.write("rig/control", True)
    rig.wait(Trigger("status/state", equal="RUN"), PATIENCE_S)
    rig.stimulus("sine", freq_Hz=PULSED_Hz, drive_V=0.05)
    half_mA = int(rig.read("parameters/max_current_mA")) / 2
    path = "current_demand/current_cmd_mA"
    got = rig.capture(
        [path, "status/is_enabled"],
        length_s=0.4,
        trigger=Trigger(path, above=half_mA),
        pre_s=0.3,
        timeout_s=PATIENCE_S,
    )
    demand, enabled = got[path], got["status/is_enabled"]
    assert demand.times_s[0] == pytest.approx(-0.3, abs=0.1)
    assert demand.times_s[-1] <= 0.4 and len(demand.times_s) > 100
    assert np.all(np.diff(demand.times_s) >= 0.0)
    first = int(np.searchsorted(demand.times_s, 0.0))
    assert demand.values[first - 1] <= half_mA < demand.values[first]
    assert len(enabled.values) and np.all(enabled.values == 1)


def test_a_trigger_counts_once_there_is_what_was_before_it() -> None:
    capture = Capture(["a"], Trigger("a", above=1.0), earliest_s=10.0)
    for time_s, value in ((9.0, 0), (9.5, 2), (9.8, 0), (10.1, 2), (10.2, 0), (10.3, 2)):
        capture.take("a", time_s, value)
    assert capture.start_s == 10.1
    before = capture.series(pre_s=0.5, length_s=0.15)["a"]
    assert np.allclose(before.times_s, [-0.3, 0.0, 0.1]) and list(before.values) == [0, 2, 0]


@pytest.mark.parametrize(
    ("act", "why"),
    [
        (lambda rig: rig.read("status/rms_um_s3"), "did you mean 'status/rms_um_s2'"),
        (lambda rig: rig.write("status/rms_um_s2", 1), "can be read, not written"),
        (lambda rig: rig.write("rig/freq_Hz", 1), "can be read, not written"),
        (lambda rig: rig.write("parameters/tick_rate_Hz", 3), "tick_rate_Hz is"),
        (lambda rig: rig.write("rig/drive_V", -1), "expected a number"),
        (lambda rig: rig.stimulus("waltz"), "expected one of"),
        (lambda rig: rig.fault("coil_open", -1), "duration_s"),
        (lambda rig: rig.capture(["parameters/law"], 1.0), "is no signal"),
        (lambda rig: rig.capture(["status/state"], -1.0), "a capture is of"),
        (lambda rig: Trigger("status/state"), "needs above, below or equal"),
        (lambda rig: rig.wait(Trigger("status/state", above=1.0)), "its trigger is equal"),
    ],
)
def test_what_is_not_allowed_is_told(rig: Rig, act, why: str) -> None:
    with pytest.raises(UsageError, match=why):
        act(rig)


def test_an_answer_that_comes_late_is_not_the_next_order_s(monkeypatch) -> None:
    with Simulation(RigSetup().words(), own_bus()) as simulation:
        process = simulation._process
        os.kill(process.pid, signal.SIGSTOP)
        monkeypatch.setattr(quiesce.rig.simulation, "ANSWER_S", 0.1)
        with pytest.raises(BenchFailure, match="does not answer"):
            simulation.order(drive_V=-1)
        monkeypatch.undo()
        os.kill(process.pid, signal.SIGCONT)
        simulation.order(drive_V=0.02)  # the first one is refused meanwhile
        with pytest.raises(UsageError, match="drive_V"):
            simulation.order(drive_V=-1)


def test_what_does_not_come_about_is_a_failure(rig: Rig) -> None:
    with pytest.raises(BenchFailure, match="did not come about"):
        rig.wait(Trigger("status/fault", equal="SUPPLY"), 0.3)
    with pytest.raises(BenchFailure, match="did not come about"):
        rig.capture(
            ["status/state"], 0.1, trigger=Trigger("status/fault", equal="SUPPLY"), timeout_s=0.3
        )


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("rig = ", "cannot be read as TOML"),
        ("speed = 1", "unknown key"),
        ("law = 1", "expected a str"),
        ("set = [1]", "NAME=VALUE"),
        ("rig = 'nowhere'", "INTERFACE:CHANNEL"),
        ("rig = 'virtual:x'\nlaw = 'phase'", "is of rig = 'host', 'mps2', 'linux'"),
        ("rig = 'linux'\ncan = 'socketcan:can0'", "no target that is started here"),
        ("bus_options = {port = 1}", "makes a bus of its own"),
        ("plant = 'none.toml'", "there is no such file"),
    ],
)
def test_files_that_are_none_are_refused(tmp_path: Path, text: str, why: str) -> None:
    file = tmp_path / "rig.toml"
    file.write_text(text)
    with pytest.raises(UsageError, match=why):
        quiesce.rig.open(file)


def test_a_plant_that_is_none_is_refused(tmp_path: Path) -> None:
    plant = tmp_path / "plant.toml"
    plant.write_text("x = 1\n")
    with pytest.raises(UsageError, match="plant.toml"), quiesce.rig.open("host", RigSetup(plant)):
        pass


def run_example(*options: str) -> subprocess.CompletedProcess[str]:
    example = ROOT / "examples/rig/test_my_rig.py"
    command = [sys.executable, "-m", "pytest", "-q", "-p", "quiesce.rig.plugin", "-c", "/dev/null"]
    return subprocess.run(
        [*command, f"--rootdir={example.parent}", str(example), *options],
        capture_output=True,
        text=True,
        env={"PYTHONPATH": str(ROOT / "tools/src"), "PATH": "/usr/bin:/bin"},
    )


@pytest.mark.slow
def test_the_example_passes_on_the_rig_and_on_its_bus(rig: Rig, tmp_path: Path) -> None:
    done = run_example(f"--junitxml={tmp_path / 'report.xml'}")
    assert done.returncode == 0, done.stdout
    assert 'failures="0"' in (tmp_path / "report.xml").read_text()
    file = tmp_path / "bus.toml"
    bus = rig.bus
    options = ", ".join(f"{key} = {str(value).lower()}" for key, value in bus.options)
    file.write_text(f"rig = '{bus.name}'\nbus_options = {{{options}}}\n")
    done = run_example(f"--rig={file}")
    assert done.returncode == 0, done.stdout
    assert "2 passed, 1 skipped" in done.stdout


@pytest.mark.slow
def test_a_rig_that_is_none_fails_in_one_line() -> None:
    done = run_example("--rig=nowhere")
    assert done.returncode == 1
    assert "INTERFACE:CHANNEL" in done.stdout and "Traceback" not in done.stdout
