"""`quiesce campaign`: what it prints, writes, replays and refuses."""

import json
import sqlite3
from pathlib import Path

import pytest
from campaign_files import FREQ, HEAD, SMALL, write
from quiesce.engine.bench import Bench

LAWS = """[[factor]]
name = "law of the case"
key = "law"
values = ["off", "fuzzy", "none"]
crossed = true
"""


def column(folder: Path, name: str) -> list:
    with sqlite3.connect(folder / "campaign.sqlite") as base:
        return [value for (value,) in base.execute(f'SELECT "{name}" FROM cases ORDER BY number')]


def test_campaign_writes_store_page_and_figures(quiesce, tmp_path: Path) -> None:
    write(tmp_path, SMALL + LAWS)
    result = quiesce("campaign", "small.toml", "--out", "out", "--workers", "2", "--json")
    assert result.returncode == 0, result.stderr
    data = json.loads(result.stdout)
    assert data == json.loads((tmp_path / "out/campaign.json").read_text())
    assert (data["cases"], data["failed"]) == (72, 24)
    assert data["reasons"][0]["cases"] == 24 and "--law none" in data["reasons"][0]["reason"]
    assert "72/72" in result.stderr.splitlines()[-1].replace("[", "").replace("]", "")
    amps = column(tmp_path / "out", "amp_um")
    groups = {(one["group"], one["figure"]): one for one in data["distributions"]}
    off = groups["off", "amp_um"]
    assert (off["least"], off["most"]) == (min(amps[0::3]), max(amps[0::3]))
    assert groups["none", "amp_um"]["cases"] == 0
    worst = data["worst"][0]
    assert worst["value"] == max(amp for amp in amps if amp is not None)
    page = (tmp_path / "out/campaign.html").read_text()
    assert worst["replay"] in page
    assert "Cases that failed" in page and 'name = "law of the case"' in page.replace("&#34;", '"')
    again = quiesce("campaign", "small.toml", "--out", "out")
    assert again.returncode == 0 and again.stderr == ""
    assert "72 cases, 24 failed" in again.stdout


@pytest.mark.parametrize("number", [17])
def test_replay_is_the_row_of_the_store(quiesce, tmp_path: Path, number: int) -> None:
    write(tmp_path)
    assert quiesce("campaign", "small.toml", "--out", "out").returncode == 0
    result = quiesce("campaign", "small.toml", "--case", str(number), "--files", "own", "--json")
    assert result.returncode == 0, result.stderr
    row = json.loads(result.stdout)
    for name, value in row.items():
        assert column(tmp_path / "out", name)[number] == value, name
    # And so is a run of the bench by itself on the case's files.
    alone = Bench().json("run", "--scenario", str(tmp_path / "own/scenario.toml"),
                         "--law", "fuzzy", "--seed", str(row["seed"]))  # fmt: skip
    assert alone["telemetry_crc32"] == row["telemetry_crc32"]
    assert alone["amp_um"] == row["amp_um"]


@pytest.mark.slow
def test_morris_and_sobol_tell_what_matters(quiesce, tmp_path: Path) -> None:
    for method, cases in (("morris", 4), ("sobol_indices", 8)):
        text = SMALL.replace("monte_carlo", method).replace("cases = 24", f"cases = {cases}")
        write(tmp_path, text)
        result = quiesce("campaign", "small.toml", "--out", method, "--json")
        assert result.returncode == 0, result.stderr
        found = json.loads(result.stdout)["sensitivity"][0]
        assert found["figure"] == "amp_um"
        at = found["head"].index("total") if method == "sobol_indices" else 0
        # Without current the frequency matters and the damper's yield force hardly.
        of_freq = found["factors"]["scenario.segment.0.freq_Hz"][at]
        assert of_freq > 10.0 * abs(found["factors"]["force"][at])


@pytest.mark.slow
def test_all_cases_failed_is_a_failure(quiesce, tmp_path: Path) -> None:
    write(
        tmp_path, (HEAD + FREQ).replace("fuzzy", "none") + "[sampling]\nmethod='sobol'\ncases=4\n"
    )
    result = quiesce("campaign", "small.toml", "--out", "out")
    assert result.returncode == 1
    assert "4 cases, 4 failed" in result.stdout
    alone = quiesce("campaign", "small.toml", "--case", "2")
    assert alone.returncode == 1
    assert len(alone.stderr.splitlines()) == 1 and "--law none" in alone.stderr


BAD = {
    "no file": (("none.toml",), "none.toml: No such file"),
    "a folder": ((".",), "Is a directory"),
    "no such case": (("small.toml", "--case", "24"), "has cases 0 .. 23"),
    "case below 0": (("small.toml", "--case", "-1"), "--case"),
    "files of no case": (("small.toml", "--files", "own"), "--case N"),
    "no workers": (("small.toml", "--workers", "0"), "expected an integer in 1 .. 1024"),
    "out is a file": (("small.toml", "--out", "small.toml"), "name another --out"),
}


@pytest.mark.parametrize("name", list(BAD))
def test_bad_words_are_refused_and_nothing_is_written(refused, tmp_path: Path, name: str) -> None:
    write(tmp_path)
    words, message = BAD[name]
    assert message in refused("campaign", *words)


@pytest.mark.slow
def test_a_changed_file_is_refused_and_the_store_is_as_it_was(quiesce, refused, tmp_path) -> None:
    write(tmp_path, SMALL.replace("24", "4"))
    assert quiesce("campaign", "small.toml", "--out", "out").returncode == 0
    before = (tmp_path / "out/campaign.sqlite").read_bytes()
    write(tmp_path, SMALL.replace("24", "8"))
    told = refused("campaign", "small.toml", "--out", "out")
    assert "4 rows that were made otherwise (file); name another --out, or remove it" in told
    assert (tmp_path / "out/campaign.sqlite").read_bytes() == before
