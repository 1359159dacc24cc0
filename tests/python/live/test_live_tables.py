"""Tables from a viewer's computer into the controller: the road of 'can load', and its refusals."""

import base64
import json
from collections.abc import Iterator

import pytest
from conftest import ROOT
from live_page import Page, Viewer
from quiesce.base.errors import UsageError
from quiesce.live.protocol import Malformed, command_of
from quiesce.live.tables import MOST_PARTS, PART_BYTES, TablePart, Upload, made
from quiesce.loading.sources import table_of

RULES = ROOT / "sim_hil/data/rules/squeeze_2012_published.fcl"
PART = {"do": "table", "kind": "rules", "name": "a.fcl", "part": 0, "parts": 1, "data": "QUI="}


def test_a_part_is_understood() -> None:
    command = command_of(json.dumps(PART), 9)
    assert command.table == TablePart("rules", "a.fcl", 0, 1, b"AB")


@pytest.mark.parametrize(
    "wrong",
    [
        {"kind": "learnt"}, {"kind": "waltz"}, {"kind": 3}, {"kind": []},
        {"name": "../a.fcl"}, {"name": ""},
        {"name": ".hidden"}, {"name": "a" * 65}, {"name": "a/b"}, {"name": None}, {"part": 1},
        {"part": -1}, {"part": True}, {"part": 0.0}, {"parts": 0}, {"parts": MOST_PARTS + 1},
        {"data": "QUI"}, {"data": "Q U I ="}, {"data": 3}, {"data": "\u00e4AAA"},
        {"data": base64.b64encode(b"x" * (PART_BYTES + 1)).decode()}, {"more": 1},
    ],
)  # fmt: skip
def test_what_is_no_part_is_malformed(wrong: dict) -> None:
    with pytest.raises(Malformed):
        command_of(json.dumps({**PART, **wrong}), 9)


def test_parts_in_their_order_are_a_file() -> None:
    upload = Upload()
    assert upload.take(TablePart("rules", "a", 0, 2, b"A")) is None
    assert upload.take(TablePart("rules", "a", 1, 2, b"B")) == b"AB"
    for strange in (
        TablePart("rules", "a", 2, 3, b""),
        TablePart("rules", "b", 1, 3, b""),
        TablePart("pulses", "a", 1, 3, b""),
        TablePart("rules", "a", 1, 4, b""),
    ):
        upload.take(TablePart("rules", "a", 0, 3, b"A"))
        with pytest.raises(UsageError, match="do not follow"):
            upload.take(strange)
        with pytest.raises(UsageError, match="do not follow"):
            upload.take(TablePart("rules", "a", 1, 3, b""))


@pytest.mark.parametrize("kind", ["rules", "pulses"])
@pytest.mark.parametrize(
    ("name", "data"),
    [("a.toml", b"a=" + b"[" * 80_000), ("a.fll", b"(" * 80_000), ("a.table", b""), ("a", b"\xff")],
)
def test_whatever_comes_is_told_in_one_line(kind: str, name: str, data: bytes) -> None:
    with pytest.raises(UsageError) as refused:
        made(kind, name, data)
    text = str(refused.value)
    assert len(text.splitlines()) == 1 and "quiesce-" not in text and name in text


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    page = Page(tmp_path_factory.mktemp("tables"), "--sim", "--law", "fuzzy")
    yield page
    assert page.end() == 0


def send(viewer: Viewer, file: str, data: bytes, kind: str = "rules") -> None:
    parts = max(1, -(-len(data) // PART_BYTES))
    for part in range(parts):
        piece = base64.b64encode(data[part * PART_BYTES : (part + 1) * PART_BYTES]).decode()
        viewer.ask("table", kind=kind, name=file, part=part, parts=parts, data=piece)


def test_who_holds_control_loads_a_table(page: Page) -> None:
    crc = table_of("rules", RULES).crc
    with page.viewer() as viewer:
        viewer.until("parameters", lambda one: one["values"])
        send(viewer, "mine.fcl", b"x")
        assert viewer.note() == {"is_ok": False, "text": "take control first", "of": "table"}
        viewer.ask("take")
        send(viewer, "mine.fcl", RULES.read_bytes())
        said = viewer.note()
        assert said["is_ok"], said["text"]
        assert f"mine.fcl: rules {crc:08x} is in use" in said["text"]
        pulses = ROOT / "firmware/plants/squeeze_2012/pulses.phase.toml"
        send(viewer, "other.phase.toml", pulses.read_bytes(), "pulses")
        said = viewer.note()  # by the controller's checker
        assert not said["is_ok"] and said["text"].startswith("refused: ")
        viewer.ask("release")


@pytest.mark.parametrize(
    ("name", "data", "kind", "why"),
    [
        ("none.fcl", b"FUNCTION_BLOCK of nothing", "rules", "none.fcl:"),
        ("none.txt", b"?", "rules", "none.txt:"),
        ("none.table", b"", "law", "none.table:"),
        ("none.table", b"\xff" * 9000, "pulses", "none.table:"),
        ("none.phase.toml", b"= 3", "pulses", "none.phase.toml:"),
        ("mine.fcl", RULES.read_bytes(), "tracker", "not a table's file"),
    ],
)
def test_what_is_no_table_is_refused_in_one_line(
    page: Page, name: str, data: bytes, kind: str, why: str
) -> None:
    with page.viewer() as viewer:
        viewer.until("parameters", lambda one: one["values"])
        viewer.ask("take")
        send(viewer, name, data, kind)
        said = viewer.note()
        viewer.ask("release")
    assert not said["is_ok"] and why in said["text"] and "\n" not in said["text"]
    assert "/tmp" not in said["text"]
