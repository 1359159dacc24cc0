"""docs/reference/boards.md has every key, with the ranges and defaults that the reader has."""

import re
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT
from quiesce.engine.bench import Bench

PAGE = (ROOT / "docs/reference/boards.md").read_text()
ROW = re.compile(r"^\| `(.+?)` \|(.*)\|$", re.MULTILINE)
BLOCK = re.compile(r"```(?:toml)?\n(.*?)```", re.DOTALL)
# Those that hold a name, a choice or a truth: the unit tests of the reader know them.
OTHER_KEYS = (
    "schema version name bodies tracked [[sensor]] sensor[].name sensor[].measures sensor[].of "
    "sensor[].axis sensor[].scale_UNIT [[damper]] damper[].name damper[].end_a damper[].end_b "
    "damper[].measures_current"
).split()
EXAMPLE = ROOT / "sim_hil/data/boards/two_storeys.toml"


@pytest.fixture(scope="module")
def keys(build: Path) -> list[dict[str, Any]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("QUIESCE_BUILD", str(build))
        return Bench().json("board-keys")


def rows() -> dict[str, list[str]]:
    """First cell -> the others."""
    return {key: [cell.strip() for cell in rest.split("|")] for key, rest in ROW.findall(PAGE)}


def number_row(key: dict[str, Any]) -> list[str]:
    """Unit, range and default. Two keys have more to say."""
    name = key["key"]
    span = "-1, 1" if name == "polarity" else f"{key['min']} .. {key['max']}"
    default = "" if key["default"] is None else str(key["default"])
    return [key["unit"], span, "`ceiling_mA`" if name == "continuous_mA" else default]


def test_every_number_has_its_range_and_default(keys) -> None:
    numbers = [key for key in keys if "measures" not in key]
    page = rows()
    assert len(numbers) > 10
    for key in numbers:
        name = f"{key['table']}[].{key['key']}" if key["table"] else key["key"]
        assert page.pop(name)[:3] == number_row(key), name
    senses = {key["measures"] for key in keys if "measures" in key}
    assert set(page) - senses == set(OTHER_KEYS)


def test_every_sensor_has_its_scale(keys) -> None:
    page = rows()
    senses = [key for key in keys if "measures" in key]
    assert len(senses) > 5
    for key in senses:
        assert page[key["measures"]][1] == f"`{key['key']}`"
        assert page["sensor[].scale_UNIT"][1] == f"{key['min']:g} .. {key['max']:.0f}"


def test_the_example_is_the_file_and_what_is_shown_of_it(quiesce) -> None:
    blocks = [text.strip() for text in BLOCK.findall(PAGE.split("## An example")[1])]
    shown = quiesce("board", "show", EXAMPLE).stdout
    assert blocks == [EXAMPLE.read_text().strip(), shown.strip()]


def test_the_message_is_what_the_reader_says(refused, tmp_path: Path) -> None:
    (tmp_path / EXAMPLE.name).write_text(
        EXAMPLE.read_text().replace("safe_mA = 0", "safe_mA = -1", 1)
    )
    message = refused("board", "check", EXAMPLE.name).removeprefix("quiesce: ").strip()
    assert f"`{message}`" in PAGE
