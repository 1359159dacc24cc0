"""Parts of `quiesce commission` by themselves: its file, its arithmetic, its order of steps."""

import json
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.commission.by_hand import to_play
from quiesce.commission.folder import STATE, Folder
from quiesce.commission.lag import lag_of_step
from quiesce.commission.run import Order, begun, listed
from quiesce.commission.samples import Samples
from quiesce.commission.simulated import bare, limit_mA
from quiesce.commission.steps import NAMES, STEPS, wiring
from quiesce.commission.steps.calibrate import from_gravity
from quiesce.commission.steps.damper import put_on
from quiesce.commission.steps.excite import rate_Hz, within
from quiesce.commission.steps.find import base_of
from quiesce.commission.steps.load import limited
from quiesce.commission.steps.tune import verified_rows
from quiesce.commission.steps.verify import require_bound, share
from quiesce.commission.steps.verify import run as verify
from quiesce.commission.steps.wiring import BEFORE, kept_parameters, limits
from quiesce.commission.wants import Wants, same, wants_of
from quiesce.commission.work import Work
from quiesce.plant.library import Plant
from quiesce.tune.law import Row

PLANT = ROOT / "sim_hil/data/plants/squeeze_2012.toml"
G_m_s2 = 9.80665


def lying(g: float, scale_nm_s2: float, offset: float, noise: float = 2.0) -> Samples:
    counts = offset + g * 1e9 * G_m_s2 / scale_nm_s2
    rng = np.random.default_rng(1)
    ticks = np.arange(2000)
    return Samples(1000, ticks, np.rint(counts + noise * rng.standard_normal(2000)))


def test_turned_over_it_tells_scale_offset_and_polarity() -> None:
    up, down = lying(-1.0, 60_000.0, 312.0), lying(1.0, 60_000.0, 312.0)
    found = from_gravity(up, down, 57_751)
    assert found["accel_scale_nm_s2"] == pytest.approx(60_000, abs=2)
    assert found["accel_offset_counts"] == 312
    assert found["accel_polarity"] == -1


@pytest.mark.parametrize(
    ("up", "down", "why"),
    [
        (lying(0.0, 60_000.0, 0.0), lying(0.0, 60_000.0, 0.0), "another axis"),
        (lying(1.0, 60_000.0, 0.0, 1e4), lying(-1.0, 60_000.0, 0.0), "it moved"),
        (lying(1.0, 3e9, 0.0, 0.0), lying(-1.0, 3e9, 0.0, 0.0), "the controller takes"),
    ],
)
def test_what_gravity_does_not_tell_is_refused(up: Samples, down: Samples, why: str) -> None:
    before_nm_s2 = 57_751 if why != "the controller takes" else 1_000_000_000
    with pytest.raises(BenchFailure, match=why):
        from_gravity(up, down, before_nm_s2)


def test_power_is_told_at_a_frequency_over_gaps() -> None:
    ticks = np.delete(np.arange(3000), slice(500, 700))
    sine = 100.0 * np.sin(2.0 * np.pi * 7.3 * ticks / 1000.0)
    rattle = 50.0 * np.sin(2.0 * np.pi * 61.0 * ticks / 1000.0)
    assert Samples(1000, ticks, 40.0 + sine).power_at(7.3) == pytest.approx(1.0, abs=1e-6)
    assert Samples(1000, ticks, sine + rattle).power_at(7.3) == pytest.approx(0.8, abs=0.02)
    assert Samples(1000, ticks, np.zeros_like(sine)).power_at(7.3) == 0.0


def test_samples_are_written_evenly_in_m_s2(tmp_path: Path) -> None:
    file = tmp_path / "before.csv"
    Samples(100, np.array([0, 1, 3]), np.array([10, 20, 40])).write(file, 0.5, 10)
    rows = file.read_text().split()
    assert rows == ["time_s,accel_m_s2", "0,0", "0.01,5", "0.02,10", "0.03,15"]


def test_the_state_is_whole_or_as_it_was(tmp_path: Path, monkeypatch) -> None:
    folder = Folder(tmp_path / "rig")
    folder.wants, folder.settings = Wants().data(), {"law": "phase"}
    folder.done("wiring", {"version": "1.0.0"})
    again = Folder(tmp_path / "rig")
    assert again.results == {"wiring": {"version": "1.0.0"}} and again.settings == folder.settings
    assert wants_of(again.wants) == Wants()

    def broken(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", broken)
    with pytest.raises(UsageError, match="No space left"):
        again.done("calibrate", {})
    assert Folder(tmp_path / "rig").results == {"wiring": {"version": "1.0.0"}}


@pytest.mark.parametrize(
    "text",
    [
        "", "{", "[]", "{}", "[" * 100_000,
        json.dumps({"schema": "quiesce-commission", "version": 2, "wants": {}, "settings": {},
                    "results": {}}),
        json.dumps({"schema": "quiesce-commission", "version": 1, "wants": {}, "settings": {},
                    "results": {"wiring": 3}}),
    ],
)  # fmt: skip
def test_a_state_that_is_none_is_refused_in_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / STATE).write_text(text)
    with pytest.raises(UsageError) as error:
        Folder(tmp_path)
    assert STATE in str(error.value) and "\n" not in str(error.value)


def test_wants_that_are_not_whole_or_differ_are_refused() -> None:
    with pytest.raises(UsageError, match="not whole"):
        wants_of({"plant": None})
    for wrong in (
        {"plant": 3}, {"start": "law=phase"}, {"start": [3]}, {"band_Hz": [1.0]},
        {"band_Hz": [1.0, "x"]}, {"modal_mass_kg": "heavy"}, {"modal_mass_kg": True},
        {"is_quick": 1}, {"mode_count": 1.5}, {"setting": None}, {"more": 1},
    ):  # fmt: skip
        with pytest.raises(UsageError, match="not whole"):
            wants_of({**Wants().data(), **wrong})
    assert wants_of({**Wants().data(), "drive_V": 1, "band_Hz": [1, 9]}).band_Hz == (1, 9)
    with pytest.raises(UsageError, match="modal_mass_kg = 1.0, now it is 2.0"):
        same(Wants(), Wants(modal_mass_kg=2.0))


def order(folder: Path, begin: str | None = None, **given: object) -> Order:
    return Order(folder, given, begin, None, False)


def test_going_back_forgets_what_came_after(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    folder.wants = Wants(plant=str(PLANT)).data()
    for name in NAMES[:5]:
        folder.done(name, {})
    after, wants = begun(order(tmp_path, "excite"))
    assert list(after.results) == ["wiring", "calibrate"]
    assert wants.plant == str(PLANT)
    with pytest.raises(UsageError, match="excite is not done yet"):
        begun(order(tmp_path, "tune"))
    with pytest.raises(UsageError, match="nothing is begun"):
        begun(order(tmp_path / "new"))
    with pytest.raises(UsageError, match="is_quick"):
        begun(order(tmp_path, plant=str(PLANT), is_quick=True))


def test_what_is_refused_changes_nothing_of_a_folder(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    folder.wants = Wants(plant=str(PLANT)).data()
    folder.done("wiring", {})
    before = folder.file.read_bytes()
    for wrong in (
        Order(tmp_path, {}, None, None, True),
        Order(tmp_path, {"drive_V": 1.0}, None, None, True),
        Order(tmp_path, {"drive_V": 1.0, "plant": None}, "wiring", None, False),
        Order(tmp_path, {"plant": str(PLANT)}, "tune", None, True),
        Order(tmp_path, {}, "tune", None, False),
        Order(tmp_path, {"plant": str(no_driver(tmp_path))}, None, None, True),
        Order(tmp_path, {"plant": str(tmp_path / "none.toml")}, "wiring", None, False),
    ):
        with pytest.raises(UsageError):
            begun(wrong)
        assert folder.file.read_bytes() == before
    with pytest.raises(UsageError, match="--from wiring does it again"):
        listed(folder)


def test_every_step_is_listed_in_its_order(tmp_path: Path) -> None:
    from quiesce.cli.commission import STEPS as WORDS

    assert [name for name, _ in listed(Folder(tmp_path))] == list(NAMES) == list(WORDS)
    assert len({one.TITLE for one in STEPS}) == len(STEPS)


def test_no_law_may_ask_for_more_than_the_limit() -> None:
    tuned = {
        "law": "phase", "max_current_mA": 5000, "unlock_current_mA": 4000,
        "constant_current_mA": 4000, "narrow_current_mA": 2000, "current_lag_ms": 5,
    }  # fmt: skip
    got = limited(tuned, 1500, has_lag=True)
    assert [got[name] for name in got if name.endswith("_mA")] == [1500] * 4
    assert "current_lag_ms" not in got  # it was measured, and given
    assert limited(tuned, 1500, has_lag=False)["current_lag_ms"] == 5
    trial = limits(600, 120, 900)
    assert trial["safe_current_mA"] == 600 and limits(600, 120, 50)["safe_current_mA"] == 50
    assert trial["max_current_mA"] == 600 and trial["current_error_mA"] == 300
    assert max(trial["constant_current_mA"], trial["unlock_current_mA"]) == 120


def stepping(lag_ticks: float, noise_mA: float, lost: tuple[int, ...] = ()) -> Any:
    """860 mA, then 215 from tick 60 on; ticks and currents."""
    ticks = np.arange(1000)
    left = np.exp(-np.maximum(ticks - 60, 0) / max(lag_ticks, 1e-9))
    current_mA = 215.0 + 645.0 * left + noise_mA * np.random.default_rng(2).standard_normal(1000)
    kept = ~np.isin(ticks, lost)
    return ticks[kept], np.rint(current_mA[kept]).astype(int)


@pytest.mark.parametrize("lag_ticks", [0.2, 1.0, 2.3, 8.0, 40.0, 150.0])
def test_the_lag_of_the_coil_is_told_by_a_step(lag_ticks: float) -> None:
    for noise_mA, lost in ((0.0, ()), (3.0, ()), (3.0, (58, 64, 65, 70))):
        found = lag_of_step(*stepping(lag_ticks, noise_mA, lost))
        assert found == pytest.approx(lag_ticks, rel=0.07, abs=0.6)


def test_a_current_that_does_not_step_tells_no_lag() -> None:
    rng = np.random.default_rng(3)
    ticks = np.arange(1000)
    assert lag_of_step(ticks, np.full(1000, 860)) is None
    assert lag_of_step(ticks, np.rint(100.0 * rng.standard_normal(1000)).astype(int)) is None
    ramp = np.linspace(860.0, 215.0, 1000)
    found = lag_of_step(ticks, np.rint(ramp).astype(int))
    assert found is None or found > 300.0


def test_the_limit_is_the_driver_s_or_less() -> None:
    assert limit_mA(Wants(plant=str(PLANT))) == 5000
    assert limit_mA(Wants(plant=str(PLANT), max_current_A=2.0)) == 2000
    assert limit_mA(Wants(plant=str(PLANT), max_current_A=9.0)) == 5000


def no_driver(folder: Path) -> Path:
    """A file that is not a whole plant."""
    file = folder / "no_driver.toml"
    text = PLANT.read_text()
    start = text.index("[driver]")
    file.write_text(text[:start] + text[text.index("\n[", start) :])
    return file


def test_a_plant_without_a_driver_is_refused_in_one_line(tmp_path: Path) -> None:
    plant = no_driver(tmp_path)
    for text in (plant.read_text(), "= 3"):
        plant.write_text(text)
        with pytest.raises(UsageError) as error:
            begun(order(tmp_path / "rig", plant=str(plant)))
        assert "no_driver.toml" in str(error.value) and "\n" not in str(error.value)
        assert not (tmp_path / "rig").exists()


def test_what_is_given_anew_changes_that_and_keeps_the_rest(tmp_path: Path) -> None:
    first = {"max_current_A": 2.0, "drive_V": 0.2, "modal_mass_kg": 7.0, "is_quick": True}
    begun(order(tmp_path, **first))
    folder = Folder(tmp_path)
    for name in NAMES[:6]:
        folder.done(name, {})
    for given in ({"damper": "mr.toml"}, {"is_quick": False}):
        with pytest.raises(UsageError, match="this folder was begun with"):
            begun(order(tmp_path, **given))
    assert begun(order(tmp_path, drive_V=0.2))[1] == Wants(**first)
    assert begun(order(tmp_path, "tune", max_current_A=1.5))[1] == Wants(
        **{**first, "max_current_A": 1.5}
    )
    wants = begun(order(tmp_path, "damper", damper="mr.toml"))[1]
    assert wants == Wants(**{**first, "max_current_A": 1.5, "damper": "mr.toml"})
    assert Folder(tmp_path).wants == wants.data()


def test_options_say_only_what_is_named(tmp_path: Path) -> None:
    import argparse

    from quiesce.cli.commission import add_parser, given_by

    parser = argparse.ArgumentParser()
    add_parser(parser.add_subparsers())
    damper = tmp_path / "mr.toml"
    damper.touch()

    def given(*words: str) -> dict[str, object]:
        return given_by(parser.parse_args(["commission", "rig", *words]))

    assert given() == given("--from", "tune") == {}
    assert given("--damper", str(damper)) == {"damper": str(damper)}
    assert given("--no-quick", "--band", "2", "9") == {"is_quick": False, "band_Hz": (2.0, 9.0)}
    assert given("--sim", str(PLANT), "--set", "law=off")["start"] == ("law=off",)


@pytest.mark.parametrize("begin", ["wiring", "excite", "find"])
def test_going_back_before_a_recording_is_going_to_record_again(tmp_path: Path, begin: str) -> None:
    folder = Folder(tmp_path)
    folder.wants = Wants(plant=str(PLANT)).data()
    for name in NAMES[:5]:
        folder.done(name, {})
    files = [to_play(tmp_path, name) for name in ("first_look", "recording")]
    for file in files:
        file.touch()
    begun(order(tmp_path, begin))
    assert [file.exists() for file in files] == [begin == "find"] * 2


def row(freq_Hz: float, is_between: bool = False) -> Row:
    bounds = None if is_between else {"amp": {}, "no_worse": {}}
    return Row(freq_Hz, is_between, bounds, [], {})


def test_frequencies_around_the_first_mode_are_verified_once_each() -> None:
    rows = [row(4.0), row(5.0, True), row(6.0), row(9.0), row(10.0), row(12.0), row(20.0)]
    assert [one.freq_Hz for one in verified_rows(rows, 10.0)] == [9.0, 10.0, 12.0]
    assert [one.freq_Hz for one in verified_rows([row(4.0), row(20.0)], 10.0)] == [4.0, 20.0]


def test_the_share_is_of_all_frequencies_together() -> None:
    rows = [{"verified_pct": 9.0, "bound_pct": 10.0}, {"verified_pct": 30.0, "bound_pct": 40.0}]
    assert share(rows) == pytest.approx(39.0 / 50.0)
    require_bound(rows)


def test_a_share_of_nothing_is_told_before_anything_is_shaken(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    folder.results["tune"] = {"predicted": [{"freq_Hz": 9.0, "bound_pct": 0.0}] * 2}

    def opened() -> None:
        raise AssertionError("it is shaken")

    with pytest.raises(BenchFailure, match="no current takes anything off") as error:
        verify(Work(Wants(), folder, lambda _: None, opened))
    assert "\n" not in str(error.value)


def test_a_recording_is_of_a_structure_with_the_damper_that_was_on_it_then(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    for has_damper in (True, False):
        folder.results["excite"] = {"has_damper": has_damper}
        work = Work(Wants(plant=str(PLANT), damper="mr.toml"), folder, print, lambda: None)
        assert (base_of(work) == PLANT) == has_damper


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"law": "phase"}', "[" * 100_000])
def test_parameters_that_are_not_whole_are_refused_in_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / BEFORE).write_text(text)
    with pytest.raises(UsageError, match=BEFORE) as error:
        kept_parameters(Work(Wants(), Folder(tmp_path), print, lambda: None))
    assert "\n" not in str(error.value)


def test_what_is_recorded_is_as_slow_as_it_may_be() -> None:
    assert (rate_Hz(10.0), rate_Hz(25.0), rate_Hz(60.0), rate_Hz(300.0)) == (200, 200, 500, 4000)
    assert within((2.0, 20.0), 0.1) == 2.0 and within((2.0, 20.0), 99.0) == 20.0


def test_a_chosen_damper_is_put_on_what_was_found_without_one(tmp_path: Path) -> None:
    import tomli_w

    structure = tmp_path / "found.toml"
    structure.write_text(tomli_w.dumps(bare(PLANT)))
    Plant(structure)
    damper = ROOT / "sim_hil/data/dampers/squeeze_2012_film.toml"
    designed = tmp_path / "plant.toml"
    name = put_on(structure, damper, designed, None, 2.0)
    assert name == tomllib.loads(damper.read_text())["name"]
    assert tomllib.loads(designed.read_text())["damper"] == {"file": "damper.toml"}
    assert Plant(designed).modes == Plant(structure).modes
    assert Plant(designed).max_current_A == 2.0
    put_on(structure, damper, designed, {"rise_s": 0.004}, 9.0)
    assert Plant(designed).max_current_A == 3.0  # that its file holds for
    assert Plant(designed).rise_s == 0.004
    (tmp_path / "none.toml").write_text("= 3")
    with pytest.raises(UsageError, match="not a damper file"):
        put_on(structure, tmp_path / "none.toml", designed, None, 2.0)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["rig"], "nothing is begun"),
        (["rig", "--sim", "none.toml"], "there is no such file"),
        (["rig", "--drive", "1", "--bus", "virtual:x"], "--max-current"),
        (["rig", "--max-current", "1", "--set", "law=phase"], "--set is of the simulated"),
        (["rig", "--sim", str(PLANT), "--band", "9", "3"], "the first must be lower"),
        (["rig", "--sim", str(PLANT), "--from", "tune"], "wiring is not done yet"),
        (["rig", "--sim", str(PLANT), "--until", "lunch"], "invalid choice"),
        ([str(PLANT), "--list"], "is a file"),
    ],
)
def test_bad_orders_are_refused_in_one_line(refused, words: list[str], why: str) -> None:
    assert why in refused("commission", *words)


class Armed:
    """A site whose trial runs, and nothing else."""

    @contextmanager
    def armed(self, why: str) -> Iterator[None]:
        yield

    def settle(self, length_s: float) -> None:
        pass


@pytest.mark.parametrize(
    ("asked_mA", "flows_mA", "why"),
    [
        (60.0, 120.0, "asks for 60 mA"),
        (120.0, -120.0, "the wrong way round"),
        (120.0, 40.0, "not that"),
    ],
)
def test_a_trial_that_goes_wrong_ends_before_the_lag_is_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, asked_mA: float, flows_mA: float, why: str
) -> None:
    def measured_lag_s(*_: object) -> None:
        raise AssertionError("more steps of a current that is not understood")

    monkeypatch.setattr(wiring, "heard", lambda *_: {"current_demand/current_cmd_mA": [asked_mA]})
    monkeypatch.setattr(wiring, "measured_mA", lambda _: flows_mA)
    monkeypatch.setattr(wiring, "measured_lag_s", measured_lag_s)
    work = Work(Wants(), Folder(tmp_path), lambda _: None, Armed)
    with pytest.raises(BenchFailure, match=why):
        wiring.driven(work, 120)
