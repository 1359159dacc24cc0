"""Inverses by several methods: made, written and read back, the semi-active condition, the map as
the firmware reads it, and the command."""

import ctypes
import datetime
import json
import subprocess
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from conftest import ROOT
from damper_actions import act, dissipative_tanh, refused, two_tones, write
from learned_data import random_motion, sine
from quiesce.base.errors import UsageError
from quiesce.cli.identify import inverse as cli_inverse
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import is_number, whole
from quiesce.damper.example import EXAMPLE
from quiesce.damper.force_map import maps_of_words
from quiesce.damper.inverse import InverseByInterpolation, forces_at
from quiesce.damper.inverses import (
    feed_forward,
    fuzzy,
    mapped,
    network,
    recurrent,
    steps,
    support_vector,
    tracking,
)
from quiesce.damper.inverses.compiled import COMPILED, Steady, beginnings, compiled, steady_map
from quiesce.damper.inverses.demand import Source, commanded, judged
from quiesce.damper.inverses.excited import excited
from quiesce.damper.inverses.made import check_names, from_file, to_compare
from quiesce.damper.inverses.methods import (
    METHODS,
    check_word,
    file_name,
    read_inverse,
    write_inverse,
)
from quiesce.damper.inverses.steps import SteppedInverse, stepped_current
from quiesce.damper.inverses.taps import held, spread
from quiesce.damper.inverses.tracking import compare, nearest, tasks_for
from quiesce.damper.learned import anfis as learned_anfis
from quiesce.damper.learned import recurrent as learned_recurrent
from quiesce.damper.learned.inputs import Box
from quiesce.damper.learned.recurrent import Settings as RecurrentSettings
from quiesce.damper.learned.sampled import sampled_rows, series_of
from quiesce.damper.simulate import simulator
from quiesce.table.file import table_bytes

pytestmark = pytest.mark.usefixtures("build")
MOST_A = 2.0
SMALL = {
    "ffn": feed_forward.Settings(hidden=(12,), epochs=25, most_rows=3000),
    "rnn": RecurrentSettings(
        hidden=(8,), feedback=(1, 2), lags=(0, 1), epochs=6, free_steps=20, sample_time_s=0.01
    ),
    "anfis": learned_anfis.Settings(memberships=3, epochs=10),
    "network": network.Settings(hidden=(12,), epochs=25, most_rows=3000),
    "svr": support_vector.Settings(rows=600),
}


@cache
def source() -> Source:
    damper = dissipative_tanh()
    return Source(excited(damper, simulator(damper), MOST_A, 3, 2), MOST_A, damper)


@cache
def made(name: str):
    more = {"settings": SMALL[name]} if name in SMALL else {}
    return METHODS[name].make(source(), 1, **more)


# Demands


def test_a_demand_that_does_not_resist_gets_no_current() -> None:
    demand = replace(two_tones(), force_N=np.full(1000, 300.0))
    wanted = judged(demand)
    assert (wanted.force_N[demand.velocity_m_s <= 0.0] == 0.0).all()
    assert (wanted.force_N[demand.velocity_m_s > 0.0] == 300.0).all()
    for name in METHODS:
        current_A = commanded(made(name), demand)
        assert (current_A[demand.velocity_m_s <= 0.0] == 0.0).all(), name
        assert (current_A >= 0.0).all() and (current_A <= MOST_A).all()


def test_nearest_is_between_no_current_and_the_largest() -> None:
    demand = replace(two_tones().rows(0, 4), force_N=np.array([0.0, 50.0, 150.0, 900.0]))
    demand = replace(demand, velocity_m_s=np.ones(4))
    bank = np.array([[100.0] * 4, [200.0] * 4])
    assert list(nearest(bank, demand)) == [100.0, 100.0, 150.0, 200.0]
    back = replace(demand, velocity_m_s=-np.ones(4), force_N=-demand.force_N)
    assert list(nearest(-bank, back)) == [-100.0, -100.0, -150.0, -200.0]


def test_stepped_current_raises_lowers_and_holds() -> None:
    def step(wanted_N: float, force_N: float, current_A: float = 0.5) -> float:
        return stepped_current(current_A, wanted_N, force_N, 100.0, 900.0, 1.5, tolerance_N=10.0)

    assert step(505.0, 500.0) == 0.5
    assert step(700.0, 500.0) == pytest.approx(0.5 + 0.5 * 1.0)
    assert step(300.0, 500.0) == pytest.approx(0.5 - 0.5 * 0.5)
    assert step(2000.0, 900.0) == 1.5
    assert step(50.0, 100.0) == 0.0


def test_steps_look_at_the_side_of_the_force() -> None:
    """A spring that pushes along the motion harder than the least current resists."""
    damper = dissipative_tanh(k_N_m=100_000.0)
    demand = replace(two_tones(), force_N=500.0 * np.sign(two_tones().velocity_m_s))
    low, high = np.sign(demand.velocity_m_s) * forces_at(damper, demand, [0.0, MOST_A])
    wrong_way = (low < -490.0) & (low > -510.0) & (high < 0.0)
    assert wrong_way.any()
    current_A = SteppedInverse(damper, 10.0, MOST_A).currents(demand)
    assert current_A[wrong_way] == pytest.approx(MOST_A)


def test_an_answer_is_held_where_the_motion_is_slow_and_between_samples() -> None:
    current_A = np.array([0.1, 0.2, 0.3, 0.4])
    kept = held(current_A, np.array([0.0, 1.0, -0.01, -1.0]), 0.1)
    assert list(kept) == [0.0, 0.2, 0.2, 0.4]
    assert list(spread(np.array([1.0, 2.0]), np.array([0, 3]), 5)) == [1.0, 1.0, 1.0, 2.0, 2.0]


# Methods


@pytest.mark.parametrize("name", list(METHODS))
def test_a_method_tracks_better_than_one_current(name: str) -> None:
    damper = dissipative_tanh()
    found = compare(damper, simulator(damper), {name: made(name)}, MOST_A, 5, 3.0)
    errors = found.errors_pct()
    # The small recurrent network of this test is hardly trained.
    assert errors[name] < (1.0 if name == "rnn" else 0.5) * errors["constant"]
    assert errors["ideal"] < 1.0


@pytest.mark.parametrize("name", list(METHODS))
def test_a_file_read_back_answers_alike(name: str, tmp_path: Path) -> None:
    file = tmp_path / file_name(name)
    write_inverse(file, name, made(name))
    method, again = read_inverse(file)
    assert method == name
    demand = replace(two_tones(), force_N=400.0 * np.sign(two_tones().velocity_m_s))
    np.testing.assert_array_equal(commanded(again, demand), commanded(made(name), demand))


@pytest.mark.parametrize("name", ["bank", "network"])
def test_a_memory_counts_in_its_own_ticks(name: str) -> None:
    """Whatever the rate of a demand, the current is that at 1 kHz."""
    if name == "network":
        section = made(name).table.sections[0]
        assert section.delay_ticks > 0 and section.rate_Hz == 1000

    def asked_A(rate_Hz: float) -> np.ndarray:
        motion = two_tones(rate_Hz)
        force_N = 400.0 * np.sign(motion.velocity_m_s) + 3e3 * motion.velocity_m_s
        return made(name).currents(judged(replace(motion, force_N=force_N)))

    at_ticks = asked_A(1000.0)
    assert np.ptp(at_ticks) > 0.2
    for every, rate_Hz in ((2, 500.0), (10, 100.0)):
        few = at_ticks[::every]
        # A demand that jumps does so between two samples, not between two ticks.
        steady = np.abs(two_tones(rate_Hz).velocity_m_s) > 0.02
        assert np.abs(asked_A(rate_Hz) - few)[steady].max() < 0.02 * MOST_A
    many = asked_A(4000.0)
    np.testing.assert_allclose(many[::4], at_ticks, atol=1e-6)
    assert (many[3::4] == many[::4]).all()


def test_training_is_the_same_for_the_same_seed() -> None:
    for name in ("ffn", "rnn"):
        again = METHODS[name].make(source(), 1, settings=SMALL[name])
        other = METHODS[name].make(source(), 2, settings=SMALL[name])
        assert again.parameters() == made(name).parameters()
        assert other.parameters() != made(name).parameters()


def test_networks_give_the_current_of_a_recording_back() -> None:
    """Between the currents that they have seen."""
    segments = [whole(sine(2.5, 5e-3, at)) for at in (0.0, 0.5, 1.0, 1.5)]
    inverse = feed_forward.make(Source(segments, 1.5), 1)
    for wanted_A in (0.25, 0.75, 1.25):
        record = sine(2.5, 5e-3, wanted_A)
        fast = np.abs(record.velocity_m_s) > 0.03
        assert np.abs(inverse.currents(record)[fast] - wanted_A).mean() < 0.12


def test_an_inverse_needs_two_currents_and_some_a_damper_file() -> None:
    still = Source([whole(random_motion(1, 2.0))], 0.5)
    for module in (feed_forward, fuzzy, recurrent):
        with pytest.raises(UsageError, match="two currents"):
            module.make(still)
    for module in (mapped, steps):
        with pytest.raises(UsageError, match="stands on a damper file"):
            module.make(still)


def test_a_force_without_end_is_refused(monkeypatch) -> None:
    damper = dissipative_tanh()

    def lost(record: Record) -> np.ndarray:
        return np.full(len(record), np.nan)

    with pytest.raises(UsageError, match="its force is not finite"):
        excited(damper, lost, MOST_A, 1, 1)
    with pytest.raises(UsageError, match="its force is not finite"):
        mapped.make(Source([], 1.0, replace(EXAMPLE, speed_m_s=1e3, stroke_m=1e3)))
    monkeypatch.setattr(tracking, "forces_by", lambda *_: lambda record, _: lost(record))
    with pytest.raises(UsageError, match="its force is not finite"):
        tasks_for(damper, lost, MOST_A, 1, 1.0)


def test_the_recurrent_inverse_states_the_error_of_what_runs() -> None:
    settings = replace(SMALL["rnn"], free_steps=100, noise=1.0)
    lines: list[str] = []
    inverse = recurrent.make(source(), 4, lines.append, settings)
    errors = []
    for one in source().segments:
        rows = sampled_rows(one.record, inverse.sample_time_s)
        part = inverse.currents(one.record)[rows] / MOST_A - one.record.command[rows] / MOST_A
        errors.append(part[rows >= one.first])
    error = float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))
    assert all(line.startswith("rnn: ") for line in lines)
    assert lines[-1] == f"rnn: {error * MOST_A:.3g} A root mean square, running free"


def test_a_free_runs_error_is_within_its_limits() -> None:
    network = learned_recurrent.Network([np.array([[5.0, 0.0]])], [np.array([0.0])])
    box = Box(("velocity_m_s",), np.array([-1.0]), np.array([1.0]))
    record = replace(two_tones(), velocity_m_s=np.ones(1000), command=np.full(1000, 2.0))
    series = series_of([whole(record)], box, (0,), 0.01, lambda one: one.command / 2.0)
    assert learned_recurrent.free_error(network, series, (1,), (0.0, 1.0)) == 0.0
    assert learned_recurrent.free_error(network, series, (1,)) == pytest.approx(4.0)
    settings, limits = replace(SMALL["rnn"], free_steps=0, feedback=(1,)), (0.0, 0.1)
    rng = np.random.default_rng(1)
    found = learned_recurrent.learned(series, settings, rng, lambda _: None, limits)
    assert found.start == found.error
    assert found.error == learned_recurrent.free_error(found.network, series, (1,), limits)
    assert found.error > 1.1 * learned_recurrent.free_error(found.network, series, (1,))


# Maps


@pytest.fixture(scope="module")
def firmware(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    library = tmp_path_factory.mktemp("force_map") / "force_map.so"
    sources = ["track/track_inverse.c", "track/force_map.c"]
    sources += ["base/sections.c", "base/table.c", "base/crc32.c"]
    folders = ["include", "base", "track"]
    subprocess.run(
        ["cc", "-std=c11", "-O1", "-shared", "-fPIC", "-o", library]
        + [f"-I{ROOT / 'firmware' / one}" for one in folders]
        + [ROOT / "firmware" / one for one in sources],
        check=True,
    )
    found = ctypes.CDLL(str(library))
    found.force_map_section.restype = ctypes.c_void_p
    return found


class Tracker(ctypes.Structure):
    """The first of a track_t (firmware/track/track.h)."""

    _fields_ = [("name", ctypes.c_char_p), ("needs", ctypes.c_uint64), ("kind", ctypes.c_void_p)]


def verdict(firmware: ctypes.CDLL, words: Sequence[int]) -> int:
    """What table_check says of them as a map."""
    kind = Tracker.in_dll(firmware, "track_inverse").kind
    raw = (ctypes.c_uint32 * len(words))(*words)
    return firmware.table_check(ctypes.c_void_p(kind), raw, len(words))


@pytest.mark.parametrize("name", ["map", "ffn", "anfis"])
def test_a_map_is_read_as_the_firmware_reads_it(name: str, firmware: ctypes.CDLL) -> None:
    inverse = made(name) if name == "map" else compiled(made(name))
    words = (ctypes.c_uint32 * len(inverse.words))(*inverse.words)
    assert verdict(firmware, inverse.words) == 0
    rng = np.random.default_rng(4)
    demand = two_tones().rows(0, 800)
    velocity_um_s = rng.integers(-400_000, 400_000, 800)
    force_mN = np.sign(velocity_um_s) * rng.integers(1, 2_000_000, 800)
    demand = replace(demand, velocity_m_s=1e-6 * velocity_um_s, force_N=1e-3 * force_mN)
    section = ctypes.c_void_p(firmware.force_map_section(words, 0))
    expected_mA = [
        firmware.force_map_current_mA(section, int(v), int(f))
        for v, f in zip(velocity_um_s, force_mN, strict=True)
    ]
    assert 1e3 * inverse.currents(demand) == pytest.approx(np.array(expected_mA), abs=1.0)


def test_map_follows_the_model_within_its_points() -> None:
    damper, record = dissipative_tanh(delta=0.0, k_N_m=0.0), two_tones()
    low, high = forces_at(damper, record, [0.0, MOST_A])
    demand = judged(replace(record, force_N=0.5 * (low + high)))
    exact = InverseByInterpolation(damper, MOST_A, 81).currents(record, demand.force_N)
    fast = np.abs(record.velocity_m_s) > 0.02
    assert np.abs(made("map").currents(demand) - exact)[fast].mean() < 0.1


def test_a_compiled_map_begins_where_the_inverse_asks_for_current() -> None:
    wanted_N = np.linspace(0.0, 10.0, 1001)
    asked_A = np.clip(0.25 * (wanted_N - 2.0), 0.0, 1.0)
    forces = beginnings(asked_A, wanted_N, np.array([0.0, 0.5, 1.0]))
    assert forces == pytest.approx([2.0, 4.0, 6.0], abs=0.02)
    never = beginnings(0.5 * asked_A, wanted_N, np.array([0.0, 0.25, 1.0]))
    assert never == pytest.approx([2.0, 4.0, 10.0], abs=0.02)


def test_the_controller_is_told_what_it_can_have() -> None:
    assert compiled(made("rnn")) is None and compiled(made("steps")) is None
    for name, module in METHODS.items():
        assert module.NAME == name and module.HELP and module.TRACKER
        assert (module.TRACKER == COMPILED) == isinstance(made(name), Steady), name
        assert from_file(name, name, made(name)).tracker == module.TRACKER


def test_a_compiled_map_takes_its_ranges_by_key() -> None:
    low = made("anfis").box.low * [0.5, 1.0, 1.0]  # the largest force is that of the other end
    one = replace(made("anfis"), box=replace(made("anfis").box, low=low))

    class Backwards:
        """Its inputs in another order."""

        box = Box(one.box.keys[::-1], one.box.low[::-1], one.box.high[::-1])
        max_current_A = MOST_A
        steady_A = one.steady_A

    there, back = steady_map(one).forces, steady_map(Backwards()).forces
    np.testing.assert_array_equal(there.force_N, back.force_N)
    np.testing.assert_array_equal(there.places, back.places)


# Broken files


BAD = [
    ("ffn", ("schema",), "quiesce-damper", "schema: expected quiesce-inverse-damper"),
    ("ffn", ("version",), 1, "schema: expected"),
    ("ffn", ("method",), "svm", "method: expected one of steps, ffn, rnn, anfis"),
    ("ffn", ("parameters",), 3, "parameters: expected a table"),
    ("ffn", ("max_current_A",), 0.0, "max_current_A: expected a number > 0"),
    ("ffn", ("max_current_A",), 1.0, "check: the file was changed"),
    ("ffn", ("parameters", "sample_time_s"), float("nan"), "sample_time_s: expected"),
    ("ffn", ("parameters", "lags"), [1, 1], "lags: expected integers rising from 0"),
    ("ffn", ("parameters", "lags"), [0, 10**9], "lags: 1000000000 is more than"),
    ("ffn", ("parameters", "force_N"), {}, "force_N.range: expected 2 finite numbers"),
    ("ffn", ("parameters", "force_N"), {"range": [1.0, 1.0]}, "FROM below TO"),
    ("ffn", ("parameters", "layer"), [], "layer: expected tables"),
    ("ffn", ("parameters", "layer", 0, "units"), 0, r"layer\[1\].units: expected an integer"),
    ("ffn", ("parameters", "layer", 0, "weights"), [1.0], r"weights: expected 72 finite"),
    ("ffn", ("parameters", "layer", 1, "biases"), ["a"], r"layer\[2\].biases: expected 1"),
    ("rnn", ("parameters", "feedback"), [0], "feedback: expected integers rising from 1"),
    ("anfis", ("parameters", "memberships"), 1, "memberships: expected an integer"),
    ("anfis", ("parameters", "widths"), [0.0] * 9, "widths: expected numbers > 0"),
    ("anfis", ("parameters", "conclusions"), [0.0], "conclusions: expected 27 finite"),
    ("ffn", ("parameters", "force_N"), {"range": [0, 1 << 70]}, "check: the file was changed"),
    ("ffn", ("parameters", "force_N"), {"range": [0, 10**400]}, "range: expected 2 finite"),
    ("ffn", ("parameters", "sample_time_s"), 10**400, "sample_time_s: expected a number"),
    ("ffn", ("made_on",), datetime.date(2024, 5, 1), "check: the file was changed"),
    ("steps", ("parameters", "tolerance_N"), True, "tolerance_N: expected a number"),
    ("steps", ("parameters", "damper"), None, "damper: expected a table"),
    ("steps", ("parameters", "damper", "model"), "nothing", "damper"),
]


@pytest.mark.parametrize(("name", "path", "value", "words"), BAD)
def test_broken_files_are_named(name, path, value, words, tmp_path: Path) -> None:
    file = tmp_path / "inverse.toml"
    write_inverse(file, name, made(name))
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    at = table
    for key in path[:-1]:
        at = at[key]
    if value is None:
        del at[path[-1]]
    else:
        at[path[-1]] = value
    file.write_text(tomli_w.dumps(table), encoding="utf-8")
    with pytest.raises(UsageError, match=words) as caught:
        read_inverse(file)
    assert "\n" not in str(caught.value) and "inverse.toml" in str(caught.value)


def test_the_check_word_is_of_everything_else() -> None:
    table = {"a": 1.0, "b": {"c": [1, 2]}}
    assert check_word(table) == check_word({"check": 7, "b": {"c": [1, 2]}, "a": 1.0})
    assert check_word(table) != check_word({"a": 1.0, "b": {"c": [2, 1]}})
    days = [check_word({"a": datetime.date(2024, 5, day)}) for day in (1, 2)]
    assert days[0] != days[1]


def test_integers_of_any_length_are_numbers_while_a_float_holds_them() -> None:
    assert is_number(1 << 70) and is_number(-1.5) and is_number(0)
    for value in (10**400, -(10**400), float("nan"), float("inf"), True, "1", None):
        assert not is_number(value)


def test_words_that_the_firmware_refuses_are_refused(firmware: ctypes.CDLL, tmp_path: Path) -> None:
    good = made("map").words
    n = good[5]
    rng = np.random.default_rng(1)
    broken = [good[:-1], good[:3], [0, *good[1:]]]
    broken += [
        [*good[:k], int(rng.integers(1 << 32)), *good[k + 1 :]]
        for k in (1, 2, 3, 4, 5, 6, 7, 7 + n, 7 + n + 1, len(good) - 1)
    ]
    for words in broken:
        assert verdict(firmware, words) != 0
        with pytest.raises(ValueError, match=".") as caught:
            maps_of_words(words)
        assert "\n" not in str(caught.value)
    file = tmp_path / "map.table"
    for data in (b"0xzz\n", b"", table_bytes(good)[:-1], table_bytes(broken[0])):
        file.write_bytes(data)
        with pytest.raises(UsageError, match="map.table"):
            read_inverse(file)


# Command line


def test_command_makes_compares_writes_and_reads_back(tmp_path: Path, capsys) -> None:
    file = write(tmp_path / "damper.toml", dissipative_tanh())
    out = tmp_path / "out"
    words = ("--max-current-A", "2", "--method", "map,steps", "--out", out)
    assert act(cli_inverse, file, *words) == 0
    told = capsys.readouterr().out
    assert "tracker inverse reads it" in told and "ideal" in told and "constant" in told
    assert {one.name for one in out.iterdir()} == {
        "map.table", "inverse_steps.toml", "inverse.html"
    }  # fmt: skip
    page = (out / "inverse.html").read_text(encoding="utf-8")
    assert page.count("<figure") == 4 and "steps" in page
    read = ("--read", out / "inverse_steps.toml", "--read", out / "map.table", "--json")
    assert act(cli_inverse, file, "--max-current-A", "2", *read) == 0
    found = json.loads(capsys.readouterr().out)
    assert [one["method"] for one in found["inverses"]] == ["steps", "map"]
    errors = found["tracking_error_pct"]
    assert errors["ideal"] < errors["inverse_steps.toml"] < errors["constant"]


def test_two_files_of_one_name_are_both_compared(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = write(tmp_path / "damper.toml", dissipative_tanh())
    files = [tmp_path / folder / "inverse.toml" for folder in ("a", "b")]
    for one, tolerance_N in zip(files, (1.0, 300.0), strict=True):
        one.parent.mkdir()
        write_inverse(one, "steps", SteppedInverse(dissipative_tanh(), tolerance_N, MOST_A))
    words = [file, "--max-current-A", "2", "--json"]
    assert act(cli_inverse, *words, "--read", files[0], "--read", files[1]) == 0
    errors = json.loads(capsys.readouterr().out)["tracking_error_pct"]
    assert errors["a/inverse.toml"] < errors["b/inverse.toml"]
    twice = ("--read", files[0], "--read", files[0])
    assert "two inverses would be named 'a/inverse.toml'" in refused(cli_inverse, *words, *twice)


def test_names_of_a_comparison_differ() -> None:
    one = from_file("steps", "one", made("steps"))
    with pytest.raises(UsageError, match="named 'one'"):
        to_compare([one, one])
    check_names(["ffn", "rnn"])
    with pytest.raises(UsageError, match="named 'ideal'"):
        check_names(["ffn", "ideal"])


def recording(file: Path, *currents_A: float, command: str = "current_A") -> Path:
    lines = [f"time_s,disp_m,velocity_m_s,force_N,{command}"]
    record = random_motion(1, 8.0)
    levels = np.array(currents_A)[(record.time_s / 0.7).astype(int) % len(currents_A)]
    force_N = forces_at(dissipative_tanh(), record, [*currents_A])
    at = (record.time_s / 0.7).astype(int) % len(currents_A)
    force_N = force_N[at, np.arange(len(record))]
    columns = (record.time_s, record.disp_m, record.velocity_m_s, force_N, levels)
    lines += [",".join(f"{value:.8g}" for value in row) for row in zip(*columns, strict=True)]
    file.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return file


def test_command_makes_an_inverse_of_a_recording(tmp_path: Path, capsys) -> None:
    file = recording(tmp_path / "rig.csv", 0.0, 1.0, 2.0, 0.5)
    assert act(cli_inverse, file, "--method", "anfis", "--out", tmp_path / "out") == 0
    assert "not compared" in capsys.readouterr().out
    assert read_inverse(tmp_path / "out/inverse_anfis.toml")[0] == "anfis"
    damper = write(tmp_path / "damper.toml", dissipative_tanh())
    words = ("--method", "anfis", "--on", damper, "--json")
    assert act(cli_inverse, file, *words) == 0
    errors = json.loads(capsys.readouterr().out)["tracking_error_pct"]
    assert errors["anfis"] < errors["constant"]


def test_bad_input_is_refused_in_one_line(tmp_path: Path) -> None:
    damper = write(tmp_path / "damper.toml", dissipative_tanh())
    data = recording(tmp_path / "rig.csv", 0.0, 1.0)
    most = ("--max-current-A", "2")
    assert "there are map, steps" in refused(cli_inverse, damper, *most, "--method", "svm")
    assert "no such file" in refused(cli_inverse, tmp_path / "no.csv", "--method", "ffn")
    assert "stands on a damper file" in refused(cli_inverse, data, "--method", "map")
    assert "name a damper file" in refused(cli_inverse, data)
    assert "name one damper file" in refused(cli_inverse, damper, data, "--method", "map")
    assert "name one damper file" in refused(cli_inverse, damper, damper, *most)
    assert "no.toml" in refused(cli_inverse, damper, *most, "--read", tmp_path / "no.toml")
    assert "schema" in refused(cli_inverse, damper, *most, "--read", damper)
    assert "expected an integer" in refused(cli_inverse, damper, "--seed", "-1")
    zero = recording(tmp_path / "zero.csv", 0.0)
    assert "no current above 0" in refused(cli_inverse, zero, "--method", "ffn")


def test_a_voltage_is_no_current(tmp_path: Path) -> None:
    good = write(tmp_path / "damper.toml", dissipative_tanh())
    volts = replace(dissipative_tanh(), valid={"command_V": [0.0, 2.25]})
    damper = write(tmp_path / "volts.toml", volts)
    read = write_steps(tmp_path / "inverse.toml")
    for words in ([damper], [damper, "--max-current-A", "2"], [damper, "--method", "map"]):
        assert "its command is a voltage" in refused(cli_inverse, *words)
    on = ("--max-current-A", "2", "--read", read, "--on", damper)
    assert "its command is a voltage" in refused(cli_inverse, good, *on)
    data = recording(tmp_path / "rig.csv", 0.0, 1.0, command="voltage_V")
    assert "its command is a voltage" in refused(cli_inverse, data, "--method", "ffn")
    both = replace(volts, valid={"command_V": [0.0, 2.25], "current_A": [0.0, 1.5]})
    assert act(cli_inverse, write(tmp_path / "both.toml", both)) == 0


def write_steps(file: Path) -> Path:
    write_inverse(file, "steps", made("steps"))
    return file


def test_options_that_nothing_reads_are_refused(tmp_path: Path) -> None:
    damper = write(tmp_path / "damper.toml", dissipative_tanh())
    data = recording(tmp_path / "rig.csv", 0.0, 1.0)
    most = ("--max-current-A", "2")
    for words in (
        ("--rate-hz", "100"), ("--force", "f"), ("--train", "part=0,0.5"), ("--flip-force",),
        ("--current-a", "1"), ("--columns", "a.toml"),
    ):  # fmt: skip
        told = refused(cli_inverse, damper, *most, "--method", "map", *words)
        assert told.startswith(f"{words[0]}: ") and "damper file" in told
    for words in (("--seed", "1"), ("--on", damper)):
        assert "are for --method or --read" in refused(cli_inverse, damper, *most, *words)
    for words in (("--max-speed-m-s", "1"), ("--amplitude-mm", "5")):
        told = refused(cli_inverse, data, "--method", "anfis", *words)
        assert "are for a damper file" in told


def test_help_has_every_method(capsys) -> None:
    with pytest.raises(SystemExit):
        act(cli_inverse, "--help")
    told = capsys.readouterr().out
    for name, module in METHODS.items():
        assert f"  {name} " in told and module.HELP in told
    assert ", ".join(METHODS) in " ".join(told.split())
