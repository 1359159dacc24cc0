"""The live page's recorder: what it is asked for, and its files beside a real controller."""

import json
import resource
from collections.abc import Iterator
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest
from asammdf import MDF
from can_bus import Controller, build_peer
from live_page import Page, Viewer
from quiesce.can.configuration import Configuration
from quiesce.can.database import load
from quiesce.can.parameters import parameters
from quiesce.can.readers import read_log
from quiesce.live.protocol import Command, Malformed, command_of
from quiesce.live.record_plan import RecordPlan, Trigger
from quiesce_benchmarks.live.rig import PATIENCE_S, close

DATABASE = load()
DEFAULTS = {one["name"]: one["default"] for one in parameters()}
PLAN = {"do": "record", "format": "csv", "before_s": 2.0, "after_s": 0, "trigger": {"on": "now"}}
LEVEL = {"on": "level", "series": 1, "level": 0.5, "is_above": True}


# What is asked for


def test_plans_are_what_the_reference_says() -> None:
    wanted = RecordPlan("csv", 2.0, 0.0, Trigger("now"))
    assert command_of(json.dumps(PLAN), 9) == Command("record", plan=wanted)
    level = command_of(json.dumps({**PLAN, "trigger": LEVEL}), 9).plan
    assert level.trigger == Trigger("level", 1, 0.5, True)
    assert command_of('{"do": "mark", "text": " here "}', 9) == Command("mark", text="here")


@pytest.mark.parametrize(
    "wrong",
    [
        {"format": "exe"}, {"format": None}, {"before_s": -1}, {"before_s": 31}, {"before_s": "2"},
        {"before_s": True}, {"after_s": 3601}, {"after_s": None}, {"trigger": "now"},
        {"trigger": {}}, {"trigger": {"on": "level"}}, {"trigger": {"on": "never"}},
        {"trigger": {"on": ["now"]}}, {"trigger": {**LEVEL, "series": 9}},
        {"trigger": {**LEVEL, "series": True}}, {"trigger": {**LEVEL, "level": "x"}},
        {"trigger": {**LEVEL, "is_above": 1}}, {"trigger": {**LEVEL, "more": 1}}, {"more": 1},
        {"do": "mark"}, {"do": "end_record"},
    ],
)  # fmt: skip
def test_other_plans_are_malformed(wrong: dict) -> None:
    with pytest.raises(Malformed):
        command_of(json.dumps({**PLAN, **wrong}), 9)


@pytest.mark.parametrize("text", ["", "  ", "a\nb", "\x07", "x" * 121, 3, None])
def test_markers_are_one_line(text: object) -> None:
    with pytest.raises(Malformed):
        command_of(json.dumps({"do": "mark", "text": text}), 9)


@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e999", "1" * 400])
def test_numbers_are_finite(number: str) -> None:
    with pytest.raises(Malformed):
        command_of(json.dumps(PLAN).replace("2.0", number), 9)


# Beside a controller


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("live_peer"))


@pytest.fixture
def page(peer: Path, tmp_path: Path) -> Iterator[Page]:
    """On the line of a controller that is armed, with every sample."""
    controller = Controller(peer, tmp_path)
    controller.start()
    one = Page(tmp_path, "--bus", controller.bus, "--raw")
    yield one
    if one.process.returncode is None:
        assert one.end() == 0
    controller.stop()


def controlling(viewer: Viewer) -> None:
    viewer.until("parameters", lambda one: one["values"])
    viewer.ask("take")
    viewer.until("state", lambda state: state["holder"] == viewer.hello["viewer"])


def told(viewer: Viewer, is_it) -> dict:
    """The state of the recorder, once it is so."""
    return viewer.until("state", lambda state: is_it(state["recorder"]))["recorder"]


def record(viewer: Viewer, **more) -> None:
    viewer.socket.send(json.dumps({**PLAN, **more}))


def finished(viewer: Viewer, count: int = 1) -> list[dict]:
    """Its files, once there are so many and nothing is under way. Two waits: making an MF4 file
    begins with loading the library for it."""
    told(viewer, lambda one: one["state"] == "ending" or len(one["files"]) >= count)
    done = told(viewer, lambda one: one["state"] == "idle" and len(one["files"]) >= count)
    return done["files"]


def download(page: Page, name: str) -> bytes:
    with urlopen(f"http://127.0.0.1:{page.port}/recordings/{name}", timeout=PATIENCE_S) as answer:
        return answer.read()


def configuration_of(file: Path) -> Configuration:
    found = Configuration(DATABASE)
    for frame in read_log(file):
        found.take(frame)
    return found


def ids_of(file: Path, name: str) -> int:
    return sum(one.arbitration_id == DATABASE.by_name[name].frame_id for one in read_log(file))


def test_csv_has_configuration_history_and_markers(page: Page, tmp_path: Path) -> None:
    with page.viewer() as viewer:
        controlling(viewer)
        viewer.watch(75)  # three seconds: there is something before
        record(viewer)
        assert viewer.note()["text"].startswith("recording quiesce_")
        told(viewer, lambda one: one["state"] == "recording" and one["duration_s"] > 2.0)
        with page.viewer() as other:  # who is not read for long is sent away
            other.ask("mark", text='a, "b"')  # needs no control
            assert other.note() == {"is_ok": True, "text": "marker 1 set", "of": "mark"}
            other.ask("end_record")
            assert other.note() == {
                "is_ok": False,
                "text": "take control first",
                "of": "end_record",
            }
        record(viewer)
        assert "stop it first" in viewer.note()["text"]
        viewer.until("state", lambda state: not state["job"])  # which tables are in use
        viewer.ask("end_record")
        files = finished(viewer, 2)
        viewer.ask("mark", text="late")
        late = viewer.until("note", lambda note: not note["is_ok"])
        assert "nothing is recorded now" in late["text"]
    names = [one["name"] for one in files]
    assert names == [names[0], f"{names[0]}.markers.csv"] and names[0].endswith(".csv")
    file = tmp_path / "recordings" / names[0]
    data = file.read_bytes()
    assert download(page, names[0]) == data and len(data) == files[0]["bytes"]
    found = configuration_of(file)
    assert found.parameters == DEFAULTS and found.identification and "law" in found.tables
    frames = list(read_log(file))
    assert frames[0].arbitration_id == DATABASE.by_name["Identification"].frame_id
    assert frames[-1].timestamp - frames[0].timestamp > 2.0
    lines = (tmp_path / "recordings" / names[1]).read_text(encoding="utf-8").splitlines()
    assert lines[0] == "time_s,text" and lines[1].endswith(',"a, ""b"""')
    assert frames[0].timestamp < float(lines[1].split(",")[0]) < frames[-1].timestamp


def test_mf4_begins_with_a_fault_and_ends_by_itself(page: Page, tmp_path: Path) -> None:
    with page.viewer() as viewer:
        controlling(viewer)
        viewer.until("state", lambda state: state["controller"]["state"] == "RUN")
        record(viewer, format="mf4", after_s=1, trigger={"on": "fault"})
        assert viewer.note() == {"is_ok": True, "text": "waiting for the trigger", "of": "record"}
        viewer.until("state", lambda s: s["recorder"]["state"] == "armed" and not s["job"])
        viewer.ask("stop")
        files = finished(viewer, 2)
    file = tmp_path / "recordings" / files[0]["name"]
    states = [
        DATABASE.decode(one.arbitration_id, bytes(one.data))["state"]
        for one in read_log(file)
        if one.arbitration_id == DATABASE.by_name["Status"].frame_id
    ]
    assert str(states[0]) == "RUN" and str(states[-1]) == "FAULT"  # before it, and after it
    assert ids_of(file, "EmergencyStop") >= 1  # what the server sent is there, too
    with MDF(file) as mdf:
        assert mdf.extract_attachment(0)[0] == DATABASE.source.encode()
        dump = json.loads(mdf.extract_attachment(1)[0])
        comment = mdf.header.comment
    assert dump["parameters"] == DEFAULTS and dump["tools"] and "law" in dump["tables"]
    assert "trigger: fault ESTOP" in comment
    assert configuration_of(file).parameters == DEFAULTS


@pytest.mark.slow
def test_level_is_passed_and_waiting_can_be_ended(page: Page, tmp_path: Path) -> None:
    """The peer's acceleration is a sine: its RMS stays, its samples pass zero downwards."""
    with page.viewer() as viewer:
        controlling(viewer)
        rms = viewer.series("Status", "rms_um_s2")
        level = {"on": "level", "level": 2.0**31, "is_above": True}
        record(viewer, trigger={**level, "series": rms})
        told(viewer, lambda one: one["state"] == "armed")
        viewer.ask("end_record")
        told(viewer, lambda one: one["state"] == "idle" and not one["files"])
        accel = viewer.series("RawSample", "accel_counts")
        record(viewer, after_s=1, trigger={**level, "series": accel, "level": 0, "is_above": False})
        files = finished(viewer, 2)
    text = (tmp_path / "recordings" / files[1]["name"]).read_text(encoding="utf-8")
    assert "trigger: acceleration below 0" in text


@pytest.mark.slow
def test_what_was_recorded_is_there_after_a_crash(page: Page, tmp_path: Path) -> None:
    with page.viewer() as viewer:
        controlling(viewer)
        record(viewer, format="mf4")
        told(viewer, lambda one: one["state"] == "recording" and one["frames"] > 1000)
        newest_s = viewer.watch(25)[-1].newest_s
        page.process.kill()
    close(page.process)
    (file,) = (tmp_path / "recordings").glob("*.mf4.log")
    frames = list(read_log(file))
    assert frames[-1].timestamp > newest_s - 1.0
    assert configuration_of(file).parameters == DEFAULTS


@pytest.mark.slow
def test_a_full_disk_is_one_note(page: Page, tmp_path: Path) -> None:
    resource.prlimit(page.process.pid, resource.RLIMIT_FSIZE, (90_000, 90_000))
    with page.viewer() as viewer:
        controlling(viewer)
        record(viewer, before_s=0)
        done = told(viewer, lambda one: one["files"])
    assert not done["said"]["is_ok"] and "File too large; recording ended" in done["said"]["text"]
    assert len(list(read_log(tmp_path / "recordings" / done["files"][0]["name"]))) > 500


@pytest.mark.slow
def test_a_folder_that_cannot_be_made_is_told(page: Page, tmp_path: Path) -> None:
    (tmp_path / "recordings").write_text("a file")
    with page.viewer() as viewer:
        record(viewer)
        assert viewer.note() == {"is_ok": False, "text": "take control first", "of": "record"}
        controlling(viewer)
        record(viewer)
        note = viewer.note()
        assert not note["is_ok"] and note["text"].startswith("cannot make recordings")
        told(viewer, lambda one: one["state"] == "idle")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["none.csv", "..%2Ftty", "%2E%2E%2Ftty", "%00"])
def test_no_other_file_is_served(page: Page, name: str) -> None:
    with pytest.raises(HTTPError) as refused:
        download(page, name)
    assert refused.value.code == 404
