"""The guided session on the page: led by who holds control, left when he is gone."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from io import StringIO
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest
from can_bus import Controller, build_peer
from conftest import ROOT
from live_page import Page, Viewer
from quiesce.base.errors import UsageError
from quiesce.can.buses import Bus
from quiesce.can.lent import lent_bus, packed, pair, unpacked
from quiesce.can.link import Link, Lost
from quiesce.can.python_can import can
from quiesce.commission.folder import Folder
from quiesce.commission.hand import Left
from quiesce.commission.led import Leader, Setup, led, setup_of
from quiesce.commission.wants import Wants
from quiesce.live.guide import MODULE
from quiesce.live.relay import Relay
from quiesce.rig import Rig, RigSetup
from quiesce.rig.simulation import Simulation, own_bus
from quiesce_benchmarks.live.rig import PATIENCE_S

PLANT = ROOT / "sim_hil/data/plants/squeeze_2012.toml"
KNOWN = ("--commission", "rig", "--first-mode", "11.5", "--quick")


@contextmanager
def leading(page: Page) -> Iterator[Viewer]:
    """One who holds control, once the steps are known."""
    with page.viewer() as viewer:
        viewer.ask("take")
        guide(viewer, lambda told: bool(told["steps"]))
        yield viewer


def order(viewer: Viewer, **what: Any) -> None:
    viewer.ask("guide", order=what)


def guide(viewer: Viewer, accept) -> dict[str, Any]:
    return viewer.until("state", lambda state: accept(state["guide"]))["guide"]


def asked(viewer: Viewer, words: str) -> dict[str, Any]:
    return guide(viewer, lambda told: told["asks"] and words in told["asks"]["text"])["asks"]


def begin(viewer: Viewer, step: str | None = None) -> None:
    """One step; what is told after this is of that."""
    before = viewer.until("state", lambda state: not state["job"])["guide"]["begun"]
    order(viewer, begin=step, is_one=True)
    guide(viewer, lambda told: told["begun"] > before)


def ended(viewer: Viewer) -> dict[str, Any]:
    return guide(viewer, lambda told: told["ended"])["ended"]


def process_of(page: Page) -> int:
    """Of its session."""
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
        if MODULE.encode() in words and parent == page.process.pid:
            return int(folder.name)
    raise AssertionError("there is no session")


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("guide_peer"))


@pytest.mark.slow
def test_a_rig_in_the_computer_is_led_step_by_step(tmp_path: Path) -> None:
    page = Page(tmp_path, "--sim", *KNOWN)
    with leading(page) as viewer:
        begin(viewer)
        guide(viewer, lambda told: told["is_at_work"])
        for do, more in (
            ("rig", {"order": {"control": True}}),
            ("set", {"settings": {"law": "off"}}),
        ):
            viewer.ask(do, **more)
            said = viewer.until("note", lambda note, do=do: note["of"] == do)
            assert said["text"] == "wait: the guided session is under way"
        assert ended(viewer) == {"is_ok": True, "text": "done"}
        told = guide(viewer, lambda told: True)
        lines = [one["line"] for one in told["steps"]]
        assert "1000 mA flow" in lines[0] and lines[1:] == [""] * 8
        viewer.until("state", lambda state: not state["job"] and not state["rig"]["control"])
        # Left in the middle of a step it goes on with that one.
        begin(viewer)
        guide(viewer, lambda told: told["is_at_work"] and "2/9" in told["says"])
        order(viewer, leave=True)
        end = ended(viewer)
        assert not end["is_ok"] and "goes on with the step" in end["text"]
        begin(viewer)
        assert ended(viewer)["is_ok"]
        told = guide(viewer, lambda told: True)
        assert "polarity +1" in told["steps"][1]["line"] and not told["steps"][2]["line"]
    assert page.end() == 0
    # The same folder at a terminal, and on a page that is started anew.
    again = Page(tmp_path, "--sim", "--commission", "rig")
    with leading(again) as viewer:
        told = guide(viewer, lambda told: True)
        assert [bool(one["line"]) for one in told["steps"]] == [True, True] + [False] * 7
    assert again.end() == 0


class Person:
    """Stands at a rig: does what the page asks for."""

    def __init__(self, rig: Simulation) -> None:
        self.rig = rig
        self.hazards: list[str] = []

    def does(self, text: str) -> None:
        if shaken := re.match(r"shake it with a sine of ([\d.]+) Hz, ([\d.]+) V", text):
            freq_Hz, drive_V = map(float, shaken.groups())
            self.rig.order(excite={"kind": "sine", "freq_Hz": freq_Hz}, drive_V=drive_V)
        elif text.startswith("switch the shaker off"):
            self.rig.order(drive_V=0.0)
        elif "give the enable" in text:
            self.rig.order(control=True)
        elif "Take your enable away" in text:
            self.rig.order(control=False)
        else:
            raise AssertionError(text)


@contextmanager
def real_rig(folder: Path) -> Iterator[tuple[Page, Person]]:
    """For the page it is a controller on a bus like any other."""
    bus = own_bus()
    with Simulation(RigSetup(PLANT).words(), bus) as rig:
        rig.order(control=False, drive_V=0.0)
        port = f"port={dict(bus.options)['port']}"
        page = Page(folder, "--bus", bus.name, "--bus-option", port, *KNOWN, "--max-current", "2",
                    "--drive", "0.1", "--as-mounted", "--base-plant", str(PLANT))  # fmt: skip
        try:
            yield page, Person(rig)
        finally:
            assert page.end() == 0


def answered(viewer: Viewer, person: Person, until: str = "") -> dict[str, Any]:
    """Whatever is asked, before what contains `until`: that, or how it ended."""
    last = 0
    while True:
        told = guide(
            viewer,
            lambda told, last=last: (
                (told["asks"] and told["asks"]["number"] > last) or told["ended"]
            ),
        )
        asks = told["asks"]
        if asks is None:
            assert not until, told["ended"]
            return told["ended"]
        if until and until in asks["text"]:
            return asks
        last = asks["number"]
        if asks["is_hazard"]:
            person.hazards.append(asks["text"])
        else:
            person.does(asks["text"])
        order(viewer, answer=True, of=last)


def arm(viewer: Viewer, person: Person) -> None:
    """Until current flows in step wiring, by an enable at hand."""
    begin(viewer)
    asks = answered(viewer, person, until="give the enable")
    person.does(asks["text"])
    order(viewer, answer=True, of=asks["number"])
    viewer.until("state", lambda state: state["controller"]["state"] == "RUN")


@pytest.mark.slow
def test_a_person_at_a_rig_is_asked_and_nothing_is_driven_without_a_yes(tmp_path: Path) -> None:
    with real_rig(tmp_path) as (page, person), leading(page) as viewer:
        begin(viewer)
        asks = answered(viewer, person, until="through the coil")
        assert asks["is_hazard"] and "up to 2 A" in asks["text"]
        assert viewer.until("state")["controller"]["is_enabled"] == 0
        order(viewer, answer=True, of=asks["number"] + 1)
        assert viewer.note()["text"] == "that is not what is asked"
        order(viewer, answer=False, of=asks["number"])
        assert "goes on with the step" in ended(viewer)["text"] and person.hazards == []
        assert viewer.until("state")["controller"]["is_enabled"] == 0
        begin(viewer)
        assert answered(viewer, person) == {"is_ok": True, "text": "done"}
        assert len(person.hazards) == 1
        line = guide(viewer, lambda told: True)["steps"][0]["line"]
        assert "400 mA asked for, 400 mA flow" in line


@pytest.mark.slow
@pytest.mark.parametrize("way", ["release", "gone", "stop"])
def test_who_lets_go_of_control_or_stops_leaves_it_safe(tmp_path: Path, way: str) -> None:
    with real_rig(tmp_path) as (page, person), ExitStack() as stack:
        with leading(page) as viewer:
            arm(viewer, person)
            other = stack.enter_context(page.viewer())
            if way != "gone":
                viewer.ask(way)
                other.until("state", lambda state: state["guide"]["is_leaving"])
        other.until("state", lambda state: state["controller"]["state"] != "RUN")
        # Its enable is still there: it was stopped, and stays so until somebody takes that away.
        other.until("state", lambda state: state["controller"]["fault"] == "ESTOP")
        assert "goes on with the step" in ended(other)["text"]


@pytest.mark.slow
def test_a_serial_adapter_is_shared_with_it(peer: Path, tmp_path: Path) -> None:
    """Only one program can have the line; the session hears and asks all the same."""
    controller = Controller(peer, tmp_path)
    controller.start("--idle")
    page = Page(tmp_path, "--bus", controller.bus, *KNOWN, "--max-current", "1", "--drive", "0.1",
                "--base-plant", str(PLANT))  # fmt: skip
    try:
        with leading(page) as viewer:
            begin(viewer)
            asked(viewer, "switch the shaker off")
            assert (tmp_path / "rig/parameters_before.json").is_file()  # asked for, each of them
            order(viewer, leave=True)
            ended(viewer)
            viewer.until("state", lambda state: not state["job"])
            viewer.ask("set", settings={"track_window_ms": "512"})
            assert viewer.note()["text"] == "1 changed and read back"
    finally:
        assert page.end() == 0
        controller.stop()


@pytest.mark.slow
def test_its_process_is_gone_with_the_server_and_missed_where_it_is_killed(tmp_path: Path) -> None:
    page = Page(tmp_path, "--sim", *KNOWN)
    with leading(page) as viewer:
        begin(viewer)
        guide(viewer, lambda told: told["is_at_work"] and told["says"])
        process = process_of(page)
        os.kill(process, signal.SIGKILL)
        end = ended(viewer)
        assert not end["is_ok"] and "process is gone" in end["text"]
        viewer.until("state", lambda state: not state["job"])
        order(viewer, begin=None, is_one=True)
        assert "process is gone" in viewer.note()["text"]
    assert page.end() == 0
    page = Page(tmp_path, "--sim", *KNOWN)
    with leading(page):
        process = process_of(page)
        page.process.kill()
    end_s = time.monotonic() + PATIENCE_S
    while Path(f"/proc/{process}/exe").exists():
        assert time.monotonic() < end_s, "it outlives its server"
        time.sleep(0.05)


@pytest.mark.slow
def test_orders_that_are_none_are_refused_and_only_reports_are_shown(tmp_path: Path) -> None:
    (tmp_path / "rig").mkdir()
    (tmp_path / "rig/report.html").write_text("<h1>of a commissioning</h1>")
    page = Page(tmp_path, "--sim", *KNOWN)
    wrong: list[dict[str, Any]] = [
        {}, {"begin": None}, {"begin": "nothing", "is_one": True}, {"begin": 1, "is_one": True},
        {"begin": None, "is_one": "yes"}, {"answer": True, "of": 1}, {"leave": True, "x": 1},
        {"begin": ["wiring"], "is_one": False},
    ]  # fmt: skip
    with page.viewer() as viewer:
        guide(viewer, lambda told: bool(told["steps"]))
        order(viewer, begin=None, is_one=True)
        assert viewer.note()["text"] == "take control first"
        viewer.ask("take")
        for what in wrong:
            order(viewer, **what)
            assert not viewer.note()["is_ok"]
        assert not guide(viewer, lambda told: True)["is_at_work"]
        begin(viewer, "verify")  # nothing is done yet
        assert "wiring is not done yet" in ended(viewer)["text"]
    with urlopen(f"{page.address}commission/report.html") as answer:
        assert b"of a commissioning" in answer.read()
        assert "sandbox" in answer.headers["content-security-policy"]
    for name in ("commission.json", "../secret", "%2e%2e/secret", "tuned/../commission.json"):
        with pytest.raises(HTTPError) as error:
            urlopen(f"{page.address}commission/{name}")
        assert error.value.code == 404
    assert page.end() == 0


@pytest.mark.slow
def test_a_folder_of_another_kind_is_refused(tmp_path: Path) -> None:
    with real_rig(tmp_path) as (page, person), leading(page) as viewer:
        begin(viewer)
        answered(viewer, person, until="shake it")
        order(viewer, leave=True)
        ended(viewer)
    page = Page(tmp_path, "--sim", "--commission", "rig")
    with leading(page) as viewer:
        begin(viewer)
        assert "this folder was begun with a controller on a bus" in ended(viewer)["text"]
    assert page.end() == 0


def test_what_is_known_is_for_a_session(quiesce) -> None:
    done = quiesce("live", "--sim", "--max-current", "2")
    assert done.returncode == 2 and "give --commission FOLDER" in done.stderr
    done = quiesce("live", "--sim", "--commission", "rig", "--damper", "no.toml")
    assert done.returncode == 2 and "no.toml: there is no such file" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("way", ["killed", "ended"])
def test_a_session_that_dies_while_it_is_armed_is_stopped(tmp_path: Path, way: str) -> None:
    """Its enable stays: a contact that nobody opens."""
    with real_rig(tmp_path) as (page, person):
        with leading(page) as viewer:
            arm(viewer, person)
            if way == "killed":
                os.kill(process_of(page), signal.SIGKILL)
                assert "process is gone" in ended(viewer)["text"]
                viewer.until("state", lambda state: state["controller"]["fault"] == "ESTOP")
        if way == "ended":
            assert page.end() == 0
            with Rig(Link(person.rig.bus)) as rig:
                assert rig.read("status/fault") == "ESTOP"


def test_a_relay_sends_what_is_said_and_tells_what_comes(peer: Path, tmp_path: Path) -> None:
    controller = Controller(peer, tmp_path)
    controller.start("--idle")
    stop = threading.Event()

    def tell() -> None:
        while not stop.is_set():
            if (event := link.receive(0.05)) is not None:
                relay.pass_on(event)

    teller = threading.Thread(target=tell)
    try:
        with Link(Bus("slcan", str(controller.path), None, ())) as link, Relay(link) as relay:
            teller.start()
            for _ in range(2):  # opened again it goes on
                with Rig(Link(lent_bus(relay.theirs.fileno()))) as rig:
                    assert rig.read("status/fault") == "NONE"
                    rig.write("parameters/track_window_ms", 512)
                    assert rig.read("parameters/track_window_ms") == 512
            stop.set()
            teller.join()
    finally:
        stop.set()
        controller.stop()


def test_frames_that_are_lent_are_those_that_come() -> None:
    frame = {"arbitration_id": 0x123, "is_extended_id": False, "timestamp": 7.25}
    for data in (b"", b"\1\2", bytes(8), bytes(range(64))):
        packet = packed(can.Message(**frame, data=data, is_fd=len(data) > 8))
        found = unpacked(packet)
        assert (found.timestamp, found.arbitration_id, bytes(found.data)) == (7.25, 0x123, data)
    for other in ({"is_extended_id": True}, {"is_remote_frame": True}, {"is_error_frame": True}):
        assert packed(can.Message(**{**frame, **other})) is None
    for wrong in (b"", bytes(11), bytes(77), bytes(8) + b"\xff" * 4 + b"\1"):
        with pytest.raises(ValueError):
            unpacked(wrong)


def test_a_bus_whose_lender_is_gone_is_lost() -> None:
    ours, theirs = pair()
    ours.send(packed(can.Message(arbitration_id=1, is_extended_id=False, timestamp=1.0)))
    with Link(lent_bus(theirs.fileno())) as link:
        assert link.receive(0.0) is None  # it was there before
        ours.close()
        lost = link.receive(5.0)
        assert isinstance(lost, Lost) and "who lent the bus is gone" in lost.reason
        assert link.send(1, b"") is None
    with (
        pytest.raises(UsageError, match="who lent the bus is gone"),
        Link(lent_bus(theirs.fileno())),
    ):
        raise AssertionError("it was opened")
    theirs.close()


class Led:
    """A session's process, by its pipes."""

    def __init__(self, folder: Path, given: dict[str, Any], *lines: str) -> None:
        bus = {"interface": "virtual", "channel": "none", "bitrate": None, "options": []}
        setup = {"folder": str(folder), "given": given, "bus": bus, "is_simulated": True}
        words = [sys.executable, "-P", "-m", MODULE]
        env = {**os.environ, "PYTHONPATH": str(ROOT / "tools/src")}
        done = subprocess.run(
            words, input="\n".join([json.dumps(setup), *lines]) + "\n", capture_output=True,
            text=True, timeout=PATIENCE_S, env=env,
        )  # fmt: skip
        assert done.returncode == 0 and "Traceback" not in done.stderr
        said = [json.loads(line) for line in done.stdout.splitlines()]
        self.ends = [one["ended"] for one in said if "ended" in one]


def begin_line(step: object) -> str:
    return json.dumps({"begin": {"step": step, "is_one": True}})


def test_lines_that_are_none_cost_nothing_and_refusals_change_nothing(tmp_path: Path) -> None:
    folder = tmp_path / "rig"
    wrong = ["", "no JSON", "[1]", "7", '{"begin": 3}', '{"nothing": 1}', '{"answer": null}']
    ends = Led(folder, {"plant": str(PLANT)}, *wrong, begin_line("nothing")).ends
    # Its input ends before it can begin: it is left, or says that there is no such step.
    assert len(ends) == 1 and not ends[0]["is_ok"] and not folder.exists()


@pytest.mark.parametrize(
    "line",
    ["", "7", "[]", "{}", '{"folder": "rig", "given": {"nothing": 1}, "bus": {}}',
     '{"folder": "rig", "given": {"drive_V": "much"}, "bus": {}, "is_simulated": true}',
     '{"folder": "rig", "given": {}, "bus": {}, "is_simulated": true}'],
)  # fmt: skip
def test_a_first_line_that_is_none_is_one_clear_line(line: str) -> None:
    with pytest.raises(UsageError, match="not whole"):
        setup_of(line)


def test_what_is_given_is_what_is_wanted() -> None:
    given = {"band_Hz": [2.0, 40.0], "max_current_A": 1.5, "start": []}
    bus = {"interface": "virtual", "channel": "a", "bitrate": None, "options": [["port", 7]]}
    said = {"folder": "rig", "given": given, "bus": bus, "is_simulated": False}
    setup = setup_of(json.dumps(said))
    assert setup.given == {"band_Hz": (2.0, 40.0), "max_current_A": 1.5, "start": ()}
    assert setup.bus == Bus("virtual", "a", None, (("port", 7),)) and not setup.is_simulated


def test_a_folder_of_a_real_rig_is_not_given_up_for_one_in_the_computer(tmp_path: Path) -> None:
    folder = Folder(tmp_path / "rig")
    folder.wants = Wants(max_current_A=1.0).data()
    folder.done("wiring", {"made": "by hand"})
    before = folder.file.read_bytes()
    setup = Setup(folder.path, {"plant": str(PLANT)}, Bus("virtual", "none", None, ()), True)
    for step in (None, "wiring"):
        is_ok, text = led(setup, Leader(StringIO()), {"step": step, "is_one": True})
        assert not is_ok and "begun with a controller on a bus" in text
    assert folder.file.read_bytes() == before


def test_an_answer_is_to_the_question_that_is_asked() -> None:
    """One that came after its question was left answers nothing later."""
    leader = Leader(StringIO())
    late = threading.Timer(0.3, leader._take, ["answer", False])
    leader._take("answer", True)
    late.start()
    with pytest.raises(Left):
        leader.allow("current")
    late.join()
