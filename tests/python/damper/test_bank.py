"""A bank of models: its words, its twin beside the firmware's integers, its fit, its command."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.cli.main import main
from quiesce.damper.bank import table
from quiesce.damper.bank.choose import Products, choose
from quiesce.damper.bank.fit import fit_bank
from quiesce.damper.bank.table import (
    Bank,
    ConstantModel,
    Element,
    bank_words,
    banks_of_words,
)
from quiesce.damper.data.record import Record
from quiesce.damper.inverse import forces_by
from quiesce.damper.inverses.banked import BankInverse, read_table
from quiesce.damper.learned.model import silent
from quiesce.damper.simulate import simulator_of_file
from quiesce.law.forms.network import DEMAND
from quiesce.law.signal import BY_NAME
from quiesce.table.file import read_words
from quiesce_benchmarks.laws.firmware_laws import Tracker, tracker_verdict

pytestmark = pytest.mark.usefixtures("build")
SOFT = root() / "sim_hil/data/dampers/rd1005_kwok_bouc_wen_soft.toml"
INPUTS = (DEMAND, BY_NAME["stroke"], BY_NAME["stroke velocity"])


def small_bank() -> Bank:
    """A stop, a saturation that leads, a dashpot; with a spring and an offset."""
    elements = (
        Element(False, 0, 40000),
        Element(True, table.ONE, 50000),
        Element(False, table.ONE // 8, table.LIMIT),
    )
    models = (
        ConstantModel(0, 3000, 5, (300, 40, 0)),
        ConstantModel(700, 3000, 5, (2000, 60, 10)),
        ConstantModel(1500, 2500, 6, (5000, 90, 15)),
    )
    return Bank(1000, 10, table.LEAD_ONE // 100, 2000, elements, models)


def demand_of(seed: int, ticks: int = 4000) -> Record:
    rng = np.random.default_rng(seed)
    t = np.arange(ticks) / 1000.0
    tones = zip((3e-3, 1e-3, 4e-4), rng.uniform(0.5, 9, 3), rng.uniform(0, 6, 3), strict=True)
    disp = sum(a * np.sin(2 * np.pi * f * t + p) for a, f, p in tones)
    force = 400.0 * np.sin(2 * np.pi * 1.7 * t) + 30.0 * rng.standard_normal(ticks)
    velocity = np.gradient(disp, 1e-3)
    return Record(
        "demand", 1000.0, t, disp, velocity, np.gradient(velocity, 1e-3), force, 0 * t, "A"
    )


def header(name: str) -> int:
    text = (ROOT / "firmware/track/force_bank.h").read_text(encoding="utf-8")
    return int(re.search(rf"#define {name} (?:UINT32_C\()?(\w+?)u?\)?\s", text)[1], 0)


def test_limits_are_those_of_the_firmware() -> None:
    assert header("FORCE_BANK_MAGIC") == table.MAGIC
    assert header("FORCE_BANK_MAX_ELEMENTS") == table.MAX_ELEMENTS
    assert header("FORCE_BANK_MIN_CURRENTS") == table.MIN_CURRENTS
    assert header("FORCE_BANK_MAX_CURRENTS") == table.MAX_CURRENTS
    assert header("FORCE_BANK_MAX_SHIFT") == table.MAX_SHIFT


def test_words_are_read_back() -> None:
    one, other = small_bank(), replace(small_bank(), lead_um_s=0)
    words = bank_words([one, other])
    assert banks_of_words(words) == (one, other)
    assert one.needs_stroke
    assert tracker_verdict(words) == 0


def test_integers_are_the_twins() -> None:
    bank = small_bank()
    inverse = BankInverse(bank_words([bank]))
    worst, size = 0.0, 0.0
    for seed in range(3):
        demand = demand_of(seed)
        values = np.column_stack([demand.force_N, demand.disp_m, demand.velocity_m_s])
        ours, exact = Tracker(inverse.words, INPUTS).currents_A(values), inverse.currents(demand)
        apart = np.abs(ours - exact)
        assert np.mean(apart > 0.01 * np.ptp(exact)) < 1e-3  # another decision, by a rounding
        worst = max(worst, float(apart[apart <= 0.01 * np.ptp(exact)].max()))
        size = max(size, float(np.ptp(exact)))
    assert size == 1.5
    assert worst < 0.005 * size


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"rate_Hz": 0}, "rate"),
        ({"shift": 41}, "shift"),
        ({"lead_um_s": -1}, "lead"),
        ({"elements": (Element(False, -1, 5),) * 3}, "leak"),
        ({"elements": (Element(False, 0, 0),) * 3}, "limit"),
        ({"elements": (Element(False, 0, 1),) * 9}, "shape"),
        ({"models": (ConstantModel(0, 0, 0, (1, 1, 1)),)}, "shape"),
        ({"models": (ConstantModel(0, 0, 0, (1, 1, 1)),) * 2}, "rise"),
        ({"models": tuple(ConstantModel(i, 0, 0, (1, -1, 1)) for i in (0, 1))}, "negative"),
        ({"models": tuple(ConstantModel(i, 2**30, 0, (1, 1, 1)) for i in (0, 1))}, "offset"),
        ({"models": tuple(ConstantModel(i, 0, 2**31 - 1, (2**31 - 1,) * 3) for i in (0, 1))},
         "too large"),
    ],
)  # fmt: skip
def test_what_the_firmware_refuses_is_refused(change: dict, says: str) -> None:
    words = bank_words([replace(small_bank(), **change)])
    with pytest.raises(ValueError, match=says):
        banks_of_words(words)
    assert tracker_verdict(words) != 0


def test_weights_are_not_negative_and_the_best_signals_are_chosen() -> None:
    rng = np.random.default_rng(1)
    signals = rng.standard_normal((3000, 6))
    force = np.stack([signals[:, 1] + 2.0 * signals[:, 4], 3.0 * signals[:, 4] - signals[:, 2]])
    error, chosen, weights = choose(Products.of(signals, force), [0], [1, 2, 3, 4, 5], 2)
    assert sorted(chosen) == [1, 4]
    assert (weights >= 0.0).all()
    assert weights[0, 1 + chosen.index(4)] == pytest.approx(2.0, abs=0.05)
    assert error < 0.3


def test_a_bank_of_a_damper_with_hysteresis_says_its_force() -> None:
    damper, _ = simulator_of_file(SOFT)
    found = fit_bank(damper, forces_by(damper, None), 1.5, 1000, 2, silent)
    assert found.mean_error_pct < 5.0
    assert max(found.error_pct) < 6.0
    assert banks_of_words(bank_words([found.bank])) == (found.bank,)


def test_why_there_is_no_bank() -> None:
    damper, _ = simulator_of_file(SOFT)
    forces = forces_by(damper, None)
    with pytest.raises(UsageError, match="no stroke or no speed"):
        fit_bank(replace(damper, stroke_m=0.0), forces, 1.5, 1000, 1, silent)
    with pytest.raises(UsageError, match=r"20 A"):
        fit_bank(damper, forces, 25.0, 1000, 1, silent)

    def constant(record: Record, currents_A: np.ndarray) -> np.ndarray:
        return np.tile(record.velocity_m_s, (len(currents_A), 1))

    with pytest.raises(UsageError, match="whole mN"):
        fit_bank(damper, constant, 1.5, 1000, 1, silent)

    def active(record: Record, currents_A: np.ndarray) -> np.ndarray:
        return -1000.0 * currents_A[:, None] * record.velocity_m_s

    with pytest.raises(UsageError, match="misses"):
        fit_bank(damper, active, 1.5, 1000, 1, silent)


def test_the_command_writes_a_bank_and_reads_it_back(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = ["identify", "inverse", str(SOFT), "--out", str(tmp_path)]
    assert main([*asked, "--method", "bank"]) == 0
    said = capsys.readouterr().out
    assert "tracker bank reads it" in said and "not fitted to" in said
    inverse = read_table(tmp_path / "bank.table")
    assert inverse.max_current_A == 1.5
    assert main([*asked, "--read", str(tmp_path / "bank.table")]) == 0
    assert "bank.table" in capsys.readouterr().out
    demand = demand_of(1)
    half = replace(
        demand,
        rate_Hz=500.0,
        **{
            name: getattr(demand, name)[::2]
            for name in ("time_s", "disp_m", "velocity_m_s", "accel_m_s2", "force_N", "command")
        },
    )
    apart = np.abs(inverse.currents(half) - inverse.currents(demand)[::2])
    assert np.median(apart) < 0.002


def test_words_of_several_dampers_are_no_inverse(tmp_path: Path) -> None:
    file = tmp_path / "two.table"
    file.write_bytes(BankInverse(bank_words([small_bank(), small_bank()])).to_bytes())
    with pytest.raises(UsageError, match="2 dampers"):
        read_table(file)


def test_banks_of_several_dampers_are_made_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [tmp_path / "a.table", tmp_path / "b.table", tmp_path / "slow.table"]
    banks = [small_bank(), replace(small_bank(), lead_um_s=0), replace(small_bank(), rate_Hz=500)]
    for file, bank in zip(files, banks, strict=True):
        file.write_bytes(BankInverse(bank_words([bank])).to_bytes())
    asked = ["identify", "inverse", "--out", str(tmp_path)]
    assert main([*asked, *map(str, files[:2])]) == 0
    assert banks_of_words(read_words(tmp_path / "bank.table")) == tuple(banks[:2])
    assert main([*asked, *map(str, files)]) == 2
    assert "different tick rates" in capsys.readouterr().err
    assert main([*asked, *map(str, [files[0]] * 5)]) == 2
    assert "5 dampers" in capsys.readouterr().err
