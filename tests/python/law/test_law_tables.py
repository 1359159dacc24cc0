"""Tables of laws: words both ways, what is refused, and that the firmware refuses the same."""

import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.law.forms.friction import FrictionSection, FrictionTable
from quiesce.law.recipe import make, values_of
from quiesce.law.recipes import RECIPES, find
from quiesce.law.rig import LawRig, load_rig
from quiesce.law.tables import FORMS, Table, table_of_words
from quiesce.table.words import opened, sealed
from quiesce_benchmarks.laws.firmware_laws import verdict

DATA = ROOT / "sim_hil/data"
BUILDING = "three_storeys_1996"


@pytest.fixture(scope="module")
def rig(build: Path) -> LawRig:
    return load_rig(
        Bench(), DATA / f"boards/{BUILDING}.toml", DATA / f"plants/{BUILDING}.toml", 1000
    )


@pytest.fixture(scope="module")
def two(build: Path) -> LawRig:
    return load_rig(Bench(), DATA / "boards/two_storeys.toml", None, 1000)


@pytest.fixture(scope="module")
def mount(build: Path) -> LawRig:
    return load_rig(Bench(), DATA / "boards/mrd_mre_2014.toml", None, 1000)


def tables(rig: LawRig) -> dict[str, Table]:
    """Of all recipes that the building takes: those for two moving ends, or a mount beside the
    damper, need another rig."""
    others = ("groundhook", "groundhook_on_off", "mixed_hooks", "bilinear", "skyhook_elastomer")
    names = [one.name for one in RECIPES if one.name not in others]
    return {name: make(find(name), rig, values_of(find(name), [])).table for name in names}


def test_every_recipe_makes_a_table_that_the_firmware_takes(rig: LawRig) -> None:
    made = tables(rig)
    assert len(made) == 18
    for name, table in made.items():
        words = table.words()
        assert verdict(table.law, words) == 0, name
        assert table_of_words(words) == table, name
        assert table.dampers() == {0}


def test_magics_are_those_of_the_firmware() -> None:
    for magic, form in FORMS.items():
        name = form.__name__.rpartition(".")[2]
        (file,) = (ROOT / "firmware/law").rglob(f"law_{name}.c")
        text = file.read_text()
        assert f"MAGIC UINT32_C(0x{magic:08X})" in text


def test_one_wrong_word_is_refused_on_both_sides(rig: LawRig) -> None:
    """Any word as any number: Python and firmware say the same of each. But for rules within a
    table: their own CRC, which the whole table's covers, only Python sums; it costs the tick that
    begins to use them more than it has."""
    dice = random.Random(5)
    ends = [0, 1, 2, 5, 13, 47, 0x104, 0x1000000, 2**30 - 1, 2**30, 2**31 - 1, 2**31, 2**32 - 1]
    refused = taken = 0
    for table in tables(rig).values():
        values = opened(table.words())
        for _ in range(150):
            spoiled = list(values)
            spoiled[dice.randrange(len(values))] = dice.choice(ends)
            words = sealed(table.words()[0], spoiled)
            try:
                table_of_words(words)
                is_good, why = True, ""
            except ValueError as error:
                is_good, why = False, str(error)
            assert "\n" not in why
            is_of_rules = table.law == "fuzzy_signals" and why.startswith("the CRC-32 of its rules")
            assert is_of_rules or (verdict(table.law, words) == 0) == is_good, words
            refused += not is_good
            taken += is_good
    assert refused > 300 and taken > 300


CUTS: list[tuple[str, Callable[[list[int]], list[int]], str]] = [
    ("nothing", lambda _: [], "is empty"),
    ("magic", lambda words: [1, *words[1:]], "begins with 0x00000001"),
    ("damaged", lambda words: [*words[:-1], words[-1] ^ 1], "CRC-32"),
    ("cut", lambda words: words[:-1], "where its head says"),
    ("head only", lambda words: words[:3], "expected 4"),
    ("longer", lambda words: sealed(words[0], [*opened(words), 0]), "after its last part"),
    ("shorter", lambda words: sealed(words[0], opened(words)[:-1]), "ends before"),
]


@pytest.mark.parametrize(("change", "message"), [case[1:] for case in CUTS], ids=lambda _: "")
def test_what_is_no_table_is_told(change: Callable, message: str) -> None:
    words = FrictionTable((FrictionSection(1, 2, 3, 4, 3),)).words()
    with pytest.raises(ValueError, match=message):
        table_of_words(change(words))


def test_a_recipe_says_which_signal_the_board_lacks(two: LawRig) -> None:
    with pytest.raises(Exception, match="board two_storeys has no force of lower"):
        make(find("bang_bang"), two, values_of(find("bang_bang"), []))


def test_a_signs_law_never_passes_the_ceiling(rig: LawRig) -> None:
    table = make(find("add"), rig, values_of(find("add"), ["on_A=20"])).table
    values = np.random.default_rng(1).normal(size=(500, len(table.signals())))
    currents = table.currents_A(values)
    assert set(np.unique(currents[:, 0])) == {0.0, 2.25}


def test_shares_of_a_current_are_of_what_the_damper_takes(rig: LawRig) -> None:
    table = make(find("quasi_bang_bang"), rig, values_of(find("quasi_bang_bang"), [])).table
    assert table.sections[0].currents_mA == (450, 2250, 2250, 450)


def test_skyhook_elastomer_is_for_two_dampers(rig: LawRig, mount: LawRig) -> None:
    words = ["sky_N_s_m=3000", "mount_N_s_m=500", "limit_N=400"]
    recipe = find("skyhook_elastomer")
    table = make(recipe, mount, values_of(recipe, words)).table
    assert verdict("linear", table.words()) == 0
    assert [one.name for one in table.signals()] == ["velocity of body 1", "velocity of body 2"]
    forces = table.forces_N(np.array([[0.1, 0.2], [-1.0, -2.0]]))
    assert forces[:, :2] == pytest.approx(np.array([[300.0, 100.0], [-400.0, -1000.0]]), abs=0.01)
    with pytest.raises(UsageError, match="three_storeys_1996 has 1 dampers; this law is for two"):
        make(recipe, rig, values_of(recipe, []))
