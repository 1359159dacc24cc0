"""The quadratic form of `bilinear`, as its table has it, beside the form itself."""

from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.law.recipe import make, values_of
from quiesce.law.recipes import find
from quiesce.law.recipes.bilinear import PAIRS, SIGNALS
from quiesce.law.rig import LawRig, load_rig
from quiesce.law.tables import table_of_words
from quiesce_benchmarks.laws.firmware_laws import demands, verdict

pytestmark = pytest.mark.usefixtures("build")
TYPICAL = np.array([3.0, 0.15, 30.0, 0.2])  # of its signals


def rig(name: str) -> LawRig:
    data: Path = ROOT / "sim_hil/data"
    return load_rig(Bench(), data / f"boards/{name}.toml", data / f"plants/{name}.toml", 1000)


def test_its_table_is_the_quadratic_form() -> None:
    recipe, rng = find("bilinear"), np.random.default_rng(1)
    names = [one.name for one in recipe.settings]
    assert len(names) == 1 + len(PAIRS) == 11
    order = list(SIGNALS)
    pairs = [(order.index(a), order.index(b)) for a, b in PAIRS]
    assert pairs == list(combinations_with_replacement(range(4), 2))
    form = rng.uniform(-4, 4, len(pairs)) / [TYPICAL[a] * TYPICAL[b] for a, b in pairs]
    words = [f"offset_A={0.3!r}"]
    words += [f"{name}={float(value)!r}" for name, value in zip(names[1:], form, strict=True)]
    table = make(recipe, rig("quarter_car"), values_of(recipe, words)).table
    values = TYPICAL * rng.standard_normal((500, 4))
    exact = 0.3 + sum(
        factor * values[:, a] * values[:, b] for factor, (a, b) in zip(form, pairs, strict=True)
    )
    assert verdict(table.law, table.words()) == 0
    assert table_of_words(table.words()) == table
    found = demands(table, values)[:, 0]  # the firmware's
    assert found == pytest.approx(table.currents_A(values)[:, 0], abs=3e-3)
    assert np.ptp(np.clip(exact, 0, 20)) > 5
    assert found == pytest.approx(np.clip(exact, 0, 20), abs=3e-3)
    told = [(one.quantity.name, one.at) for one in table.signals()]
    assert told == [
        ("acceleration", 1), ("velocity", 1), ("acceleration", 0), ("stroke velocity", 0),
    ]  # fmt: skip


def test_a_damper_on_the_ground_is_refused() -> None:
    recipe = find("bilinear")
    with pytest.raises(UsageError, match="stands on the ground"):
        make(recipe, rig("three_storeys_1996"), values_of(recipe, []))
