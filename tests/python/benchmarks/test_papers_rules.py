"""The part rules of `./tools/benchmark papers`: the labelled rule bases, and the command."""

import json
from pathlib import Path

import numpy as np
import pytest
from quiesce.rules.formats.files import read_rules
from quiesce.rules.model import RuleBase, Singleton
from quiesce.rules.reference import evaluate
from quiesce_benchmarks.cli import main
from quiesce_benchmarks.papers import rules_bases
from quiesce_benchmarks.papers.rules_bases import (
    FROZEN,
    LEVELLED,
    PUBLISHED,
    RMS,
    SHIPPED,
    frozen_bases,
    held_at,
)


def rows(file: Path) -> dict[str, list[float]]:
    """Currents by frequency set, a column an RMS set."""
    base = read_rules(file)
    found: dict[str, list[float]] = {}
    for rule in base.rules:
        term = base.outputs[0].terms[rule.conclusions[0]]
        assert isinstance(term, Singleton)
        found.setdefault(base.inputs[0].sets[rule.conditions[0].set].name, []).append(term.value)
    return found


def current_A(base: RuleBase, freq_Hz: float, rms_m_s2: float) -> float:
    return float(evaluate(base, [np.array([freq_Hz]), np.array([rms_m_s2])]).outputs[0, 0])


def test_only_the_shipped_rules_do_without_the_rms_input() -> None:
    assert all(len(set(columns)) == 1 for columns in rows(SHIPPED).values())
    assert any(len(set(columns)) > 1 for columns in rows(PUBLISHED).values())
    assert any(len(set(columns)) > 1 for columns in rows(LEVELLED).values())
    assert all(len(columns) == 1 for columns in rows(FROZEN).values())


def test_published_rules_differ_from_the_shipped_ones_at_5_Hz_only() -> None:
    shipped, published = rows(SHIPPED), rows(PUBLISHED)
    assert {name for name in shipped if shipped[name] != published[name]} == {"S"}
    assert published["S"] == [2.5, 5.0, 5.0, 5.0]


def test_a_held_column_is_the_base_at_that_rms() -> None:
    base = read_rules(LEVELLED)
    for column, one in enumerate(base.inputs[RMS].sets):
        top = next(x for x, share in one.points if share == 1.0)
        held = held_at(base, column)
        for freq_Hz in (8.0, 9.0, 10.5, 12.0, 14.0, 16.0):
            expected_A = current_A(base, freq_Hz, top)
            for anywhere in (0.0, top, 2.0):
                assert current_A(held, freq_Hz, anywhere) == pytest.approx(expected_A)
    assert set(frozen_bases(base)) == {"searched"} | {f"held at {k}" for k in ("S", "M", "H", "VH")}


def test_judged_levels_are_none_of_those_searched() -> None:
    searched = {0.3, 0.9, 1.5}  # --drive of the command in the files
    for file in (LEVELLED, FROZEN):
        assert "--drive 0.3,0.9,1.5" in file.read_text()
    assert not searched & set(rules_bases.MACHINE.drives_V)


@pytest.fixture(scope="module")
def measured(build: Path, tmp_path_factory: pytest.TempPathFactory) -> dict:
    folder = tmp_path_factory.mktemp("papers")
    assert main(["papers", "--part", "rules", "--quick", "--json", "--out", str(folder)]) == 0
    return json.loads((folder / "papers.json").read_text())


def test_the_third_rig_needs_its_rms_input(measured) -> None:
    values = {one["name"]: one["value"] for one in measured["figures"]}
    left = measured["context"]["reported"]["rules"]["left_pct"]
    best = min(left["frozen"].values())
    assert values["rms_matters_gain_pct"] == pytest.approx(best - left["with_rms"], abs=1e-3)
    assert values["rms_matters_gain_pct"] >= 5.0


def test_no_constant_current_of_the_third_rig_is_right_at_every_level(measured) -> None:
    found = measured["context"]["reported"]["rules"]["by_constant"]
    best = set()
    for place in ("12 Hz 0.2 V", "12 Hz 0.9 V", "12 Hz 1.5 V"):
        gains = {one: at[place]["displacement"] for one, at in found.items()} | {"0 A": 0.0}
        best.add(max(gains, key=lambda one: gains[one]))
    assert "0 A" in best and len(best) > 1


def test_published_rules_give_the_published_figures(measured) -> None:
    found = measured["context"]["reported"]["rules"]
    published, best = found["cantilever"]["as_published"], found["cantilever"]["best"]
    assert published["5 Hz 0.1 V"]["displacement"] == pytest.approx(2.83, abs=0.1)
    assert best["5 Hz 0.1 V"]["displacement"] == pytest.approx(0.0, abs=0.01)
    for freq_Hz in (10, 15, 20):
        assert 22.0 <= published[f"{freq_Hz} Hz 0.1 V"]["displacement"] <= 27.0
