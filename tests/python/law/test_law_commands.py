"""`quiesce law list`, `make`, `show`, and the bench with their tables."""

import json
from pathlib import Path

import pytest
from conftest import ROOT

DATA = ROOT / "sim_hil/data"
BOARD = DATA / "boards/three_storeys_1996.toml"
PLANT = DATA / "plants/three_storeys_1996.toml"
TWO = DATA / "boards/two_storeys.toml"


def test_list_names_every_recipe_and_says_what_one_takes(quiesce) -> None:
    all_of_them = json.loads(quiesce("law", "list", "--json").stdout)
    text = quiesce("law", "list").stdout
    files = {one.stem for one in (ROOT / "tools/src/quiesce/law/recipes").glob("*.py")}
    assert set(all_of_them) == files - {"__init__", "common"}
    assert all(f"\n{name} " in text for name in all_of_them)
    assert all(one["equation"] and one["source"] and one["when"] for one in all_of_them.values())
    one = quiesce("law", "list", "sh_add").stdout
    assert "cross_Hz" in one and "0.01 .. 100" in one and "source" in one
    assert "tracker" in quiesce("law", "list", "skyhook").stdout


@pytest.mark.parametrize(
    ("recipe", "parts"),
    [
        (
            "clipped_optimal",
            ["law linear, demands force", "acceleration of body 3", "damping ratio"],
        ),
        ("skyhook_on_off", ["sign 1: +1 velocity of body 1; band 0.001", "++ 2.25 A"]),
        ("quasi_bang_bang", ["-- 0.45 A", "+- 2.25 A", "++ 0.45 A"]),  # shares of the ceiling
        ("modulated_friction", ["50000 N/m", "both"]),
        ("polynomial", ["2 A |stroke velocity of damper 1|^1"]),
        ("fuzzy_skyhook", ["1: velocity of body 1 1 -0.1 m/s", "1 is 5 0 A 1.125 A 2.25 A"]),
        ("tsk", ["0 A -10 A per m/s of 2 0 A +10 A per m/s of 2"]),
    ],
)
def test_what_is_made_is_shown(quiesce, tmp_path: Path, recipe: str, parts: list[str]) -> None:
    file = tmp_path / "folder/law.table"
    made = quiesce("law", "make", recipe, "--board", BOARD, "--plant", PLANT, "-o", file)
    assert made.returncode == 0, made.stderr
    assert made.stdout.startswith(f"{recipe}: ") and "run it" in made.stdout
    shown = quiesce("table", "show", file)
    assert shown.returncode == 0, shown.stderr
    text = " ".join(shown.stdout.split())
    for part in parts:
        assert part in text


def test_make_tells_programs_its_headroom(quiesce, tmp_path: Path) -> None:
    options = ["--board", BOARD, "--plant", PLANT, "-o", tmp_path / "x.table", "--json"]
    told = json.loads(quiesce("law", "make", "clipped_optimal", *options).stdout)
    assert told["headroom_dB"] == pytest.approx(6.02, abs=0.1)
    assert told["pole_error"] < 1e-5 and told["gain_error"] < 1e-5
    assert told["law"] == "linear" and told["demands"] == "force"
    static = json.loads(quiesce("law", "make", "skyhook", *options).stdout)
    assert static["headroom_dB"] is None


BAD = [
    (["law", "list", "nothing"], "no recipe 'nothing'; there are: clipped_optimal"),
    (["law", "make", "add", "--board", "none.toml", "-o", "x"], "none.toml"),
    (
        ["law", "make", "add", "--board", BOARD, "--set", "on=1", "-o", "x"],
        "add has no 'on'; it has",
    ),
    (["law", "make", "add", "--board", BOARD, "--set", "on_A", "-o", "x"], "a number in 0 .. 20"),
    (["law", "make", "add", "--board", BOARD, "--set", "on_A=nan", "-o", "x"], "0 .. 20"),
    (["law", "make", "add", "--board", BOARD, "--set", "on_A=21", "-o", "x"], "0 .. 20"),
    (["law", "make", "bang_bang", "--board", TWO, "-o", "x"], "no force of lower; it has:"),
    (["law", "make", "groundhook", "--board", BOARD, "-o", "x"], "stands on the ground"),
    (["law", "make", "clipped_optimal", "--board", BOARD, "-o", "x"], "--plant FILE"),
    (
        ["law", "make", "clipped_optimal", "--board", BOARD, "--plant", "none.toml", "-o", "x"],
        "none.toml: No such file",
    ),
    (
        ["law", "make", "clipped_optimal", "--board", BOARD]
        + ["--plant", DATA / "plants/squeeze_2012.toml", "-o", "x"],
        "given by modes",
    ),
    (
        ["law", "make", "clipped_optimal", "--board", BOARD]
        + ["--plant", DATA / "plants/two_storeys.toml", "-o", "x"],
        "nothing is called 'first' there",
    ),
    (
        ["law", "make", "clipped_optimal", "--board", BOARD, "--plant", BOARD, "-o", "x"],
        "given by modes",
    ),
    (
        ["law", "make", "modulated_friction", "--board", BOARD]
        + ["--set", "outward=0", "--set", "back=0", "-o", "x"],
        "never act",
    ),
]


@pytest.mark.parametrize(("words", "message"), BAD)
def test_bad_input_is_one_line(quiesce, tmp_path: Path, words: list, message: str) -> None:
    result = quiesce(*words)
    assert result.returncode == 2
    assert message in result.stderr
    assert result.stderr.count("\n") == 1 and result.stderr.startswith("quiesce: ")
    assert not Path("x").exists()
