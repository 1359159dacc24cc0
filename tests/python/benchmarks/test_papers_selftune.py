"""The part selftune of `./tools/benchmark papers`: its readings, its figures, the command."""

import json
from pathlib import Path

import pytest
from quiesce.engine.laws import LAWS, find, published_law
from quiesce_benchmarks.cli import main
from quiesce_benchmarks.papers.parts import selftune

SETTINGS = ("selftune_polarity", "selftune_upper_mHz")


def setting(law: str, name: str) -> int:
    return int(dict(text.split("=") for text in find(law).settings)[name])


def test_readings_are_both_signs_with_and_without_the_gate() -> None:
    readings = [tuple(setting(law.name, key) for key in SETTINGS) for law in selftune.READINGS]
    assert sorted(readings) == [(-1, 7500), (-1, 100000), (1, 7500), (1, 100000)]
    assert selftune.READINGS[0].name == selftune.GATED
    assert tuple(setting(selftune.GATED, key) for key in SETTINGS) == (1, 7500)


def test_published_figures_stand_beside_every_reading() -> None:
    assert {published_law(law.name) for law in selftune.READINGS} == {"fuzzy_selftune_printed"}
    assert all(published_law(law.name) == law.name for law in LAWS if "selftune" not in law.name)
    assert selftune.published_pct() == {"10Hz": 26.39, "20Hz": 27.99, "5Hz": 13.4}


@pytest.fixture(scope="module")
def measured(build: Path, tmp_path_factory: pytest.TempPathFactory) -> dict:
    folder = tmp_path_factory.mktemp("papers")
    words = ["papers", "--part", "selftune", "--quick", "--json", "--out", str(folder)]
    assert main(words) == 0
    return json.loads((folder / "papers.json").read_text())


def test_gated_the_rules_act_in_the_step_and_the_tuning_at_5_Hz(measured) -> None:
    readings = measured["context"]["reported"]["selftune"]["readings"]
    gated, fuzzy = readings[selftune.GATED], readings["fuzzy"]
    assert (gated["10Hz"], gated["20Hz"]) == (fuzzy["10Hz"], fuzzy["20Hz"])
    assert gated["5Hz"] == readings["fuzzy_selftune_printed"]["5Hz"] != fuzzy["5Hz"]
    ceiling = readings["constant_5A"]
    assert all(gated[window] <= ceiling[window] + 1e-3 for window in ("10Hz", "20Hz"))


def test_figures_are_those_of_the_gated_reading(measured) -> None:
    figures = {one["name"]: one["value"] for one in measured["figures"]}
    readings = measured["context"]["reported"]["selftune"]["readings"]
    assert figures["selftune_gated_10Hz_pct"] == readings[selftune.GATED]["10Hz"]
    assert figures["selftune_gated_20Hz_pct"] == readings[selftune.GATED]["20Hz"]
    assert 22.7 < figures["selftune_gated_10Hz_pct"] < 22.9
    spread = measured["context"]["reported"]["selftune"]["gated_over_noise_seeds"]["10Hz"]
    assert spread["least"] <= spread["mean"] <= spread["most"]
