"""`quiesce live --sim`: a rig in the computer behind the page."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT
from live_page import Page, Viewer
from quiesce.can.database import load
from quiesce.can.python_can import can
from quiesce.rules.formats.files import read_rules
from quiesce.rules.integers.controller import controller_file
from quiesce.table.file import read_data
from quiesce_benchmarks.live.rig import PATIENCE_S

RIG = "quiesce_bench"


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """For those who leave the rig in control of nobody."""
    page = Page(tmp_path_factory.mktemp("sim"), "--sim")
    yield page
    assert page.end() == 0


def children(page: Page) -> list[int]:
    """Rigs that this page has started."""
    found = subprocess.run(
        ["pgrep", "-P", str(page.process.pid), RIG[:15]], capture_output=True, text=True
    )
    return [int(one) for one in found.stdout.split()]


def until_gone(pid: int) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while Path(f"/proc/{pid}/exe").exists():
        assert time.monotonic() < end_s, f"{pid} is still there"
        time.sleep(0.02)


def order(viewer: Viewer, **what: object) -> None:
    viewer.ask("rig", order=what)


def rig_state(viewer: Viewer, accept) -> dict:
    return viewer.until("state", lambda state: state["rig"] and accept(state["rig"]))["rig"]


def acknowledge(viewer: Viewer) -> None:
    """Again where the stop has still held: it does for a moment after its last frame."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        order(viewer, fault={"kind": "fault_reset", "duration_s": 0.1})
        for _ in range(3):
            if viewer.until("state")["controller"]["fault"] == "NONE":
                return
    raise AssertionError("the fault stays")


def test_a_viewer_in_control_moves_the_rig(shared: Page) -> None:
    with shared.viewer() as viewer:
        assert viewer.hello["rig"]["plant"] == "squeeze_2012"
        order(viewer, control=False)
        assert viewer.note() == {"is_ok": False, "text": "take control first", "of": "rig"}
        viewer.ask("take")
        order(viewer, control=False, excite={"kind": "sine", "freq_Hz": 11.5}, drive_V=0.05)
        found = rig_state(viewer, lambda rig: not rig["control"] and rig["freq_Hz"] == 11.5)
        assert found["drive_V"] == 0.05
        viewer.until("state", lambda state: state["controller"]["is_enabled"] == 0)
        off = rig_state(viewer, lambda rig: rig["vibration"]["off"])["vibration"]["off"]
        order(viewer, control=True)
        viewer.until("state", lambda state: state["controller"]["state"] == "RUN")
        rig = rig_state(viewer, lambda rig: rig["vibration"]["on"])
        assert rig["vibration"]["on"]["displacement_um"] < off["displacement_um"]
        viewer.ask("release")


@pytest.mark.parametrize(("target", "name"), [("mps2", "mps2"), ("linux", "quiesced")])
def test_its_controller_may_run_elsewhere(tmp_path: Path, target: str, name: str) -> None:
    page = Page(tmp_path, "--sim", "--target", target)
    with page.viewer() as viewer:
        assert viewer.hello["rig"]["target"] == name
        viewer.until("state", lambda state: state["controller"]["state"] == "RUN")
        viewer.ask("take")
        viewer.ask("stop")
        viewer.until("state", lambda state: state["stop"]["state"] == "confirmed")
    assert page.end() == 0


def test_faults_reach_the_controller_and_are_acknowledged(shared: Page) -> None:
    with shared.viewer() as viewer:
        viewer.ask("take")
        order(viewer, fault={"kind": "estop", "duration_s": 0.1})
        viewer.until("state", lambda state: state["controller"]["fault"] == "ESTOP")
        acknowledge(viewer)
        viewer.ask("release")


@pytest.mark.slow
def test_stop_of_the_page_stops_it(shared: Page) -> None:
    with shared.viewer() as viewer:
        viewer.ask("take")
        viewer.ask("stop")
        viewer.until("state", lambda state: state["stop"]["state"] == "confirmed")
        acknowledge(viewer)
        viewer.ask("release")


@pytest.mark.slow
def test_another_law_is_for_when_control_is_off(shared: Page) -> None:
    with shared.viewer() as viewer:
        viewer.until("parameters", lambda one: one["values"])
        viewer.ask("take")
        order(viewer, control=False)
        viewer.until("state", lambda state: state["controller"]["is_enabled"] == 0)
        viewer.ask("set", settings={"law": "constant"})
        assert viewer.note()["is_ok"]
        viewer.ask("set", settings={"law": "phase"})
        assert viewer.note()["is_ok"]
        order(viewer, control=True)
        viewer.until("state", lambda state: state["controller"]["state"] == "RUN")
        viewer.ask("save")
        assert "not stored" in viewer.note()["text"]
        viewer.ask("release")


@pytest.mark.parametrize(
    ("what", "why"),
    [
        ({}, "an order to the rig has keys of"),
        ({"speed": 3}, "an order to the rig has keys of"),
        ({"control": 1}, "control: expected true or false"),
        ({"drive_V": "loud"}, "drive_V: expected a number"),
        ({"drive_V": None}, "no value of an order"),
        ({"excite": {"kind": "waltz"}}, "kind: expected one of"),
        ({"excite": {"kind": "sine", "freq_Hz": -1}}, "freq_Hz: expected a number"),
        ({"excite": {"kind": "sine", "freq_Hz": 1e400}}, "no value of an order"),
        ({"excite": {"kind": "record", "record": 99}}, "no such record"),
        ({"excite": {"kind": "record", "file": "/etc/passwd"}}, "no such record"),
        ({"excite": {"kind": "si\nne"}}, "kind: expected one of"),
        ({"excite": {"a b": 1}}, "no key of an order"),
        ({"fault": {"kind": "estop"}}, "duration_s"),
        ({"drive_V": 10**400}, "too large a number"),
    ],
)
def test_orders_that_are_none_are_refused_in_one_line(shared: Page, what: dict, why: str) -> None:
    with shared.viewer() as viewer:
        viewer.ask("take")
        order(viewer, **what)
        note = viewer.note()
        assert not note["is_ok"] and why in note["text"] and "\n" not in note["text"]
        viewer.ask("release")


def test_records_are_chosen_by_number(shared: Page) -> None:
    with shared.viewer() as viewer:
        records = viewer.hello["rig"]["records"]
        viewer.ask("take")
        pulse = records.index("base_pulse")
        order(viewer, excite={"kind": "record", "record": pulse, "gain": 0.05, "time_scale": 5})
        rig_state(viewer, lambda rig: "from base_pulse, " in rig["excitation"])
        viewer.ask("release")


def test_other_programs_join_its_bus(shared: Page) -> None:
    with shared.viewer() as viewer:
        words = viewer.hello["rig"]["bus"].split()
    port = int(words[-1].removeprefix("port="))
    channel = words[1].partition(":")[2]
    status = load().by_name["Status"]
    with can.Bus(interface="udp_multicast", channel=channel, port=port) as bus:
        seen = set()
        end_s = time.monotonic() + PATIENCE_S
        while status.frame_id not in seen and time.monotonic() < end_s:
            frame = bus.recv(1.0)
            seen.update([frame.arbitration_id] if frame else [])
    assert status.frame_id in seen


def tables_on(page: Page) -> str:
    """What `quiesce can tables` says of the rig."""
    with page.viewer() as viewer:
        words = viewer.hello["rig"]["bus"].split()
    done = subprocess.run(
        [sys.executable, "-m", "quiesce", "can", "tables", *words],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_it_starts_with_rules_of_the_user(tmp_path: Path) -> None:
    rules = ROOT / "sim_hil/data/rules/isolated_machine.fcl"
    page = Page(tmp_path, "--sim", "--law", "fuzzy", "--rules", str(rules))
    crc = read_data(controller_file(read_rules(rules))).words[1]
    assert f"rules   {crc:08x}  file" in tables_on(page)
    assert page.end() == 0


@pytest.mark.slow
def test_the_rig_does_not_outlive_a_page_that_is_killed(tmp_path: Path) -> None:
    page = Page(tmp_path, "--sim")
    (rig,) = children(page)
    page.process.kill()
    page.process.communicate()
    until_gone(rig)


def test_a_rig_that_dies_ends_the_page_in_one_line(tmp_path: Path) -> None:
    page = Page(tmp_path, "--sim")
    (rig,) = children(page)
    os.kill(rig, signal.SIGKILL)
    _, said = page.process.communicate(timeout=PATIENCE_S)
    assert page.process.returncode == 1
    assert said.splitlines()[-1].endswith(
        "the rig in the computer is gone: the rig ended with signal SIGKILL"
    )
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (("--sim", "none.toml"), "none.toml: there is no such file"),
        (("--sim", "--law", "waltz"), "--law waltz"),
        (("--sim", "--rules", "none.fis"), "none.fis"),
        (("--sim", "--pulses", "none.table"), "none.table: there is no such file"),
        (("--sim", "--law", "fuzzy", "--rules", "bad.table"), "bad.table"),
        (("--force-map", "x.table", "--bus", "virtual:x"), "--force-map is of the rig"),
        (("--sim", "--set", "law"), "law"),
        (("--sim", "--record", "none.csv"), "none.csv: cannot be read"),
        (("--sim", "--bus", "virtual:x"), "--sim makes a bus of its own"),
        (("--law", "phase", "--bus", "virtual:x"), "--law is of the rig in the computer"),
        (("--sim", "bad.toml"), "bad.toml"),
        (("--sim", "--record", "bad.csv"), "bad.csv: its first line is to name"),
    ],
)
def test_bad_options_are_refused_in_one_line(
    tmp_path: Path, options: tuple[str, ...], why: str
) -> None:
    (tmp_path / "bad.toml").write_text("x = 1\n")
    (tmp_path / "bad.table").write_bytes(b"no table")
    (tmp_path / "bad.csv").write_text("a,b\n1,2\n")
    done = subprocess.run(
        [sys.executable, "-m", "quiesce", "live", "--port", "0", *options],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools/src")},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 2
    assert why in done.stderr and len(done.stderr.splitlines()) == 1
