"""`quiesce compare` on the bench, with a short shaking."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from scipy.io import loadmat

DATA = ROOT / "sim_hil/data"


@pytest.fixture
def quake(tmp_path: Path) -> Path:
    t = np.arange(0, 3, 0.01)
    accel = np.sin(2 * np.pi * 3.0 * t) * np.exp(-t)
    file = tmp_path / "quake.csv"
    file.write_text(
        "t_s,acc_g\n" + "".join(f"{a:.3f},{b:.6f}\n" for a, b in zip(t, accel, strict=True))
    )
    return file


RIG = ["--rig", "two_storeys", "--accel-column", "acc_g", "--scale-to", "0.5"]


def test_laws_stand_beside_constants_in_all_files(quiesce, quake: Path, tmp_path: Path) -> None:
    table = tmp_path / "sky.table"
    board = DATA / "boards/three_storeys_1996.toml"
    assert quiesce("law", "make", "skyhook_on_off", "--board", board, "-o", table).returncode == 0
    law = f"signs:table={table},as=sky"
    rig = ["--rig", "three_storeys_1996", *RIG[2:]]  # its sensors have noise
    words = [*rig, "--record", quake, "--law", law, "--seeds", "2", "--out", tmp_path / "out"]
    result = quiesce("compare", *words)
    assert result.returncode == 0, result.stderr
    assert "sky, quake, seed 2" in result.stderr
    for name in ("sky", "no current", "all current", "best constant"):
        assert name in result.stdout
    cells = json.loads((tmp_path / "out/compare.json").read_text())
    assert len(cells) == 2 * 4
    by_law = {(cell["law"], cell["seed"]): cell for cell in cells}
    for seed in (1, 2):
        assert by_law["all current", seed]["index"] == pytest.approx(1.0)
        best = by_law["best constant", seed]
        assert best["index"] <= 1.0 and best["note"].endswith(" A")
        still = by_law["no current", seed]["figures"]
        assert still["current_mean_A"] == 0
        assert still["disp_rms_mm"] > by_law["sky", seed]["figures"]["disp_rms_mm"] > 0.01
        assert by_law["sky", seed]["figures"]["chatter_A_s"] > 1.0
    assert by_law["sky", 1]["figures"] != by_law["sky", 2]["figures"]  # other noise
    rows = list(csv.DictReader((tmp_path / "out/compare.csv").open()))
    assert [row["law"] for row in rows] == [cell["law"] for cell in cells]
    page = (tmp_path / "out/compare.html").read_text()
    assert page.count("<figure") == 3 and "sky" in page


def test_the_same_seeds_give_the_same_numbers(quiesce, quake: Path) -> None:
    words = ["compare", *RIG, "--record", quake, "--law", "fuzzy", "--json"]
    assert quiesce(*words).stdout == quiesce(*words).stdout


def test_what_laws_did_goes_to_other_programs(quiesce, quake: Path, tmp_path: Path) -> None:
    words = ["compare", *RIG, "--record", quake, "--law", "fuzzy:as=a/b", "--out", tmp_path / "out"]
    result = quiesce(*words, "--format", "mat")
    assert result.returncode == 0, result.stderr
    stems = ("no_current", "all_current", "a_b")
    assert f"history_quake_{stems[2]}.mat" in result.stdout
    found = {
        stem: loadmat(tmp_path / f"out/history_quake_{stem}.mat", simplify_cells=True)
        for stem in stems
    }
    assert np.ptp(np.diff(found["a_b"]["t_s"])) < 1e-9
    assert found["no_current"]["upper_current_cmd_mA"].max() == 0.0
    assert found["all_current"]["upper_current_cmd_mA"].max() > 0.0
    cells = json.loads((tmp_path / "out/compare.json").read_text())
    peak_mm = next(one["figures"]["disp_peak_mm"] for one in cells if one["law"] == "a/b")
    peaks = [np.abs(values).max() for name, values in found["a_b"].items() if "true_um" in name]
    assert max(peaks) * 1e-3 >= peak_mm * 0.99


def test_format_without_a_folder_is_refused(quiesce, quake: Path) -> None:
    result = quiesce("compare", *RIG, "--record", quake, "--format", "uff")
    assert result.returncode == 2 and "--out FOLDER says where" in result.stderr


def test_at2_files_are_read(quiesce, tmp_path: Path) -> None:
    t = np.arange(0, 2, 0.02)
    values = [f"{x: .7E}" for x in 0.05 * np.sin(2 * np.pi * 3 * t)]
    lines = [" ".join(values[i : i + 5]) for i in range(0, len(values), 5)]
    head = "A STATION\nAN EVENT\nACCELERATION IN UNITS OF G\nNPTS=  100, DT=   .0200 SEC,\n"
    file = tmp_path / "quake.AT2"
    file.write_text(head + "\n".join(lines) + "\n")
    words = ["compare", "--rig", "two_storeys", "--record", file, "--json"]
    cells = json.loads(quiesce(*words).stdout)["cells"]
    assert {cell["record"] for cell in cells} == {"quake"}
    file.write_text(head.replace("100", "99") + "\n".join(lines) + "\n")
    assert "100 numbers where NPTS says 99" in quiesce(*words).stderr


BAD = [
    ([], "name the structure"),
    (["--rig", "nowhere"], "--rig nowhere: there are: "),
    (["--rig", "two_storeys", "--board", "x.toml"], "give it or them"),
    ([*RIG, "--law", "nothing"], "no law 'nothing'"),
    ([*RIG, "--law", "fuzzy:rules"], "expected key=value"),
    ([*RIG, "--law", "signs:table=none.table"], "there is no file none.table"),
    ([*RIG, "--law", "fuzzy", "--law", "fuzzy"], "two are called 'fuzzy'"),
    ([*RIG, "--law", "fuzzy:nothing=1"], "nothing"),
    ([*RIG, "--law", "linear"], "law linear works with a table"),
    ([*RIG, "--seeds", "0"], "expected an integer in 1 .. 1000"),
    (["--rig", "squeeze_2012"], "the plant has no such one"),
]


@pytest.mark.parametrize(("words", "message"), BAD)
def test_bad_input_is_one_line(quiesce, quake: Path, words: list[str], message: str) -> None:
    column = [] if "--accel-column" in words else ["--accel-column", "acc_g"]
    result = quiesce("compare", *words, *column, "--record", quake)
    assert result.returncode == 2, result.stdout
    lines = [line for line in result.stderr.splitlines() if line.startswith("quiesce: ")]
    assert len(lines) == 1 and message in lines[0]


MALFORMED = [
    ("", "empty"),
    ("t_s,acc_m_s2\n", "rows of data"),
    ("t_s,acc_m_s2\n0,1\n0.01,x\n0.02,1\n", ":3:"),
    ("t_s,acc_m_s2\n0,1\n0.01,nan\n0.02,1\n", "cut these rows"),
    ("t_s,acc_m_s2\n0,1\n0.01,2\n0.05,1\n0.06,1\n", "0.0"),
    ("t_s,acc_m_s2\n0,0\n0.01,0\n0.02,0\n", "all of it is 0"),
    ("t_s,acc_m_s2\n0,1e5\n0.01,0\n0.02,0\n", "in which unit"),
    ("t_s,other\n0,1\n0.01,0\n0.02,0\n", "no column 'acc_m_s2'"),
]


@pytest.mark.parametrize(("text", "message"), MALFORMED)
def test_a_malformed_record_is_one_line(quiesce, tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "bad.csv"
    file.write_text(text)
    result = quiesce("compare", "--rig", "two_storeys", "--record", file)
    assert result.returncode == 2
    assert message in result.stderr and result.stderr.count("\n") == 1


@pytest.mark.parametrize("text", ["", "no head\n1 2 3\n", "a\nb\nc\nNPTS=3, DT=0.01\n1 2 x\n"])
def test_a_malformed_at2_is_one_line(quiesce, tmp_path: Path, text: str) -> None:
    file = tmp_path / "bad.at2"
    file.write_text(text)
    result = quiesce("compare", "--rig", "two_storeys", "--record", file)
    assert result.returncode == 2 and result.stderr.count("\n") == 1


def test_recipes_on_several_structures(quiesce, quake: Path, tmp_path: Path) -> None:
    """Each recipe's table is made for each of them; what one cannot serve is told."""
    result = quiesce(
        "compare", "--rig", "two_storeys", "--rig", "three_storeys_1996", *RIG[2:],
        "--record", quake, "--recipe", "skyhook_on_off:on_A=1,as=sky", "--recipe", "bang_bang",
        "--out", tmp_path / "out",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    cells = json.loads((tmp_path / "out/compare.json").read_text())
    rigs = list(dict.fromkeys(cell["rig"] for cell in cells))
    assert len(rigs) == 2
    assert [cell["law"] for cell in cells if cell["rig"] == rigs[1]][3:] == ["sky", "bang_bang"]
    assert [cell["law"] for cell in cells if cell["rig"] == rigs[0]][3:] == ["sky"]
    assert "left out: board two_storeys has no force of" in result.stdout
    sky = [cell["figures"]["current_mean_A"] for cell in cells if cell["law"] == "sky"]
    assert all(0.0 < one <= 1.0 for one in sky)
    page = (tmp_path / "out/compare.html").read_text()
    assert page.count("<figure") == 6 and page.count("<h2>") >= 2


@pytest.mark.parametrize(
    ("recipe", "told"),
    [
        ("nonsense", "no recipe 'nonsense'"),
        ("add:on_A", "expected key=value"),
        ("add:sky=2", "no setting or parameter 'sky'"),
        ("add:on_A=21", "expected a number in 0 .. 20"),
        ("skyhook", "takes a damper's map: map=FILE"),
        ("skyhook:map=/no/where", "there is no file"),
        ("bang_bang", "no force of"),
    ],
)
def test_a_recipe_that_cannot_be_is_refused(quiesce, quake: Path, recipe: str, told: str) -> None:
    result = quiesce("compare", *RIG, "--record", quake, "--recipe", recipe)
    assert result.returncode == 2
    assert told in result.stderr and len(result.stderr.splitlines()) == 1


def test_one_structure_named_twice_is_refused(quiesce, quake: Path) -> None:
    result = quiesce("compare", *RIG, "--rig", "two_storeys", "--record", quake)
    assert result.returncode == 2 and "is named twice" in result.stderr
