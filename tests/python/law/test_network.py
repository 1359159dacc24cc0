"""Networks: integers beside float64, of law and tracker; words both ways; fits."""

import random
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.engine.bench import Bench
from quiesce.law.describe import described
from quiesce.law.fit import KINDS as KINDS_OF_FIT
from quiesce.law.fit import fit
from quiesce.law.forms.network import (
    DEMAND,
    MAGIC,
    TRACK_MAGIC,
    NetworkSection,
    NetworkTable,
    NetworkTrackTable,
    Span,
    read,
    read_tracker,
)
from quiesce.law.rig import LawRig, load_rig
from quiesce.law.signal import BY_NAME, Signal, signal
from quiesce.network.dense import Network
from quiesce.network.integers import dense_layer, of_dense, output_of, radial_layer
from quiesce.network.layers import Dense, Layers
from quiesce.network.radial import (
    as_rules,
    best_rules,
    chosen,
    fitted,
    gaussians,
    with_centres,
)
from quiesce.table.file import read_words, table_bytes
from quiesce.table.words import opened, sealed
from quiesce_benchmarks.laws.firmware_laws import (
    NetworkTracker,
    demands,
    library,
    tracker_verdict,
    verdict,
)

TICKS = 5000
RATE_Hz = 1000
STROKES = ("stroke of brace", "stroke velocity of brace")
SPANS = (
    Span.of(signal("stroke", 0), -0.03, 0.03),
    Span.of(signal("stroke velocity", 0), -0.4, 0.4),
    Span.of(signal("temperature", 0), 15.0, 95.0),
)


def motion(seed: int) -> np.ndarray:
    """[ticks 3], now and then beyond the spans."""
    rng = np.random.default_rng(seed)
    t = np.arange(TICKS)[:, None] / 1000.0
    tones = np.sin(2 * np.pi * t * rng.uniform(0.5, 9.0, 3) + rng.uniform(0, 6, 3))
    return tones * (0.035, 0.45, 45.0) + (0.0, 0.0, 55.0)


def random_dense(rng: np.random.Generator, sizes: tuple[int, ...]) -> Layers:
    network = Network.random(sizes, rng)
    for biases in network.biases:
        biases[:] = rng.normal(size=len(biases))
    network.biases[-1][:] = 1.5
    return of_dense(network, 700.0)


def random_radial(rng: np.random.Generator, values: int, rules: bool) -> Layers:
    centres = rng.uniform(-1, 1, (9, values))
    layer = radial_layer(centres, rng.uniform(0.5, 6.0, centres.shape), rules)
    shape = (9, 1 + values) if rules else (9,)
    return Layers((layer,), output_of(900.0, 600.0 * rng.normal(size=shape)))


def mixed(rng: np.random.Generator) -> Layers:
    """A straight line, then rules."""
    line = Dense(False, dense_layer(rng.normal(size=(3, 3)), rng.normal(size=3)).rows)
    rules = random_radial(rng, 3, True)
    return Layers((line, *rules.layers), rules.output)


KINDS = {
    "one layer": lambda rng: (0, random_dense(rng, (3, 12, 1))),
    "two layers": lambda rng: (0, random_dense(rng, (3, 12, 8, 1))),
    "delayed": lambda rng: (4, random_dense(rng, (6, 10, 1))),
    "radial": lambda rng: (0, random_radial(rng, 3, False)),
    "rules": lambda rng: (0, random_radial(rng, 3, True)),
    "rules, delayed": lambda rng: (2, random_radial(rng, 6, True)),
    "line and rules": lambda rng: (0, mixed(rng)),
}


def made(kind: str) -> NetworkTable:
    delay_ticks, layers = KINDS[kind](np.random.default_rng(4))
    rate_Hz = RATE_Hz if delay_ticks else 0
    return NetworkTable((NetworkSection(SPANS, delay_ticks, 2500, layers, 0, rate_Hz),))


def track_section(least_um_s: int = 20_000) -> NetworkSection:
    spans = (Span.of(Signal(DEMAND, 0), -1500.0, 1500.0), *SPANS[:2])
    layers = random_dense(np.random.default_rng(8), (6, 9, 1))
    return NetworkSection(spans, 2, 1800, layers, least_um_s, RATE_Hz)


def test_exp_and_tanh_are_within_two_to_the_minus_23() -> None:
    import ctypes

    exp, tanh = library().exp_minus_q24, library().tanh_q24
    exp.restype, exp.argtypes = ctypes.c_uint32, [ctypes.c_uint32]
    at = np.concatenate([np.arange(0, 20 * 2**24, 9973), np.arange(0, 2**32, 2**32 // 9999)])
    found = np.array([exp(int(u)) for u in at])
    assert np.abs(found - 2.0**24 * np.exp(-at / 2.0**24)).max() < 2.0
    at = np.concatenate([np.arange(-(2**27), 2**27, 9973), [-(2**29), 2**29, 0, 1, -1]])
    found = np.array([tanh(int(x)) for x in at])
    assert np.abs(found - 2.0**24 * np.tanh(at / 2.0**24)).max() < 2.0


@pytest.mark.parametrize("kind", list(KINDS))
def test_integers_are_a_rounding_from_float64(kind: str) -> None:
    table, values = made(kind), motion(1)
    exact = table.currents_A(values)
    assert np.ptp(exact[:, 0]) > 0.5
    assert np.abs(demands(table, values) - exact).max() < 1e-3


@pytest.mark.parametrize("kind", list(KINDS))
def test_words_both_ways(kind: str) -> None:
    table = made(kind)
    assert verdict("network", table.words()) == 0
    assert read(table.words()) == table
    assert read_tracker(NetworkTrackTable((track_section(),)).words()).sections == (
        track_section(),
    )


def test_tracker_is_a_rounding_from_float64() -> None:
    """Of two dampers, the second with another least speed."""
    table = NetworkTrackTable((track_section(), track_section(0)))
    values = motion(2)
    wanted_N = 1800.0 * np.sin(np.arange(TICKS) / 90.0)[:, None]
    values = np.hstack([np.where(np.abs(wanted_N) < 100.0, 0.0, wanted_N), values[:, :2]])
    exact = table.currents_A(np.hstack([values, values]))
    for i in range(2):
        assert 0.3 < np.mean(exact[:, i] == 0.0) < 0.8 and np.ptp(exact[:, i]) > 0.5
        assert np.abs(NetworkTracker(table, i).currents_A(values) - exact[:, i]).max() < 1.1e-3
    against = values[:, 0] * values[:, 2] < 0.0
    assert against.any() and not exact[against].any()


def spoiled(values: list[int], dice: random.Random) -> list[int]:
    ends = [0, 1, 2, 3, 5, 8, 9, 33, 36, 37, 60, 61, 64, 0x104, 2**24 - 1, 2**24, 2**26, 2**26 + 1,
            2**30 - 1, 2**30, 2**31 - 1, 2**31, 2**32 - 1, 2**32 - 2**24]  # fmt: skip
    out = list(values)
    out[dice.randrange(len(values))] = dice.choice(ends)
    return out


def test_one_wrong_word_is_refused_on_both_sides() -> None:
    """Any word as any number: Python and firmware say the same of each."""
    dice = random.Random(5)
    tables = {MAGIC: [made(kind) for kind in KINDS]}
    tables[TRACK_MAGIC] = [NetworkTrackTable((track_section(),))]
    refused = taken = 0
    for magic, several in tables.items():
        for table in several:
            for _ in range(250):
                words = sealed(magic, spoiled(opened(table.words()), dice))
                try:
                    (read if magic == MAGIC else read_tracker)(words)
                    is_good = True
                except ValueError as error:
                    assert "\n" not in str(error)
                    is_good = False
                said = verdict("network", words) if magic == MAGIC else tracker_verdict(words)
                assert (said == 0) == is_good, words
                refused += not is_good
                taken += is_good
    assert refused > 300 and taken > 300


def test_too_much_is_refused_before_it_is_written() -> None:
    layers = random_dense(np.random.default_rng(1), (3, 24, 1))
    section = NetworkSection(SPANS, 0, 1000, layers)
    assert verdict("network", NetworkTable((section,)).words()) == 0
    with pytest.raises(ValueError, match="instructions a tick; 5000 are allowed"):
        NetworkTable((section, section)).words()
    with pytest.raises(ValueError, match="delayed by 5 ticks; 12 values fit"):
        NetworkTable((NetworkSection(SPANS, 5, 1000, layers, 0, RATE_Hz),)).words()
    for delay_ticks, rate_Hz in ((0, RATE_Hz), (2, 0), (2, -1)):
        with pytest.raises(ValueError, match=f"{rate_Hz} of them a second"):
            NetworkTable((NetworkSection(SPANS, delay_ticks, 1000, layers, 0, rate_Hz),)).words()
    with pytest.raises(ValueError, match="beyond 2"):
        output_of(0.0, np.array([1e8]))


def test_a_span_never_passes_its_ends() -> None:
    for low, high in ((-0.03, 0.03), (15.0, 95.0), (-1e6, 1e6), (0.0, 1e-3)):
        span = Span.of(Signal(BY_NAME["temperature"], 0), low, high)
        scaled = span.scaled(np.array([low - 1.0, low, 0.5 * (low + high), high, high + 1.0]))
        assert (np.abs(scaled) <= 1.0).all()
        assert scaled[:2] == pytest.approx(-1.0) and scaled[3:] == pytest.approx(1.0, abs=1e-6)


# Fits


def samples(count: int) -> tuple[np.ndarray, np.ndarray]:
    x = np.random.default_rng(3).uniform(-1, 1, (count, 2))
    return x, np.clip(0.5 + 0.4 * np.tanh(4 * x[:, 0] * x[:, 1]) + 0.2 * x[:, 1], 0.0, 1.0)


@pytest.mark.parametrize(("of_rules", "most"), [(False, 0.06), (True, 0.03)])
def test_a_fit_follows_a_law_that_it_has_not_seen_all_of(of_rules: bool, most: float) -> None:
    x, target = samples(3000)
    fit, error = fitted(x, target, 14, np.random.default_rng(1), of_rules)
    assert len(fit.centres) == 14 and error < most
    assert float(np.std(target)) > 5 * error
    new, exact = samples(500)
    found = np.clip(fit.layers(1000.0).sums_mA(new) / 1000.0, 0.0, 1.0)
    assert np.sqrt(np.mean((found - exact) ** 2)) < 1.3 * most


def test_centres_are_chosen_by_what_they_add() -> None:
    """Three Gaussians among fifty candidates are found again."""
    candidates = np.random.default_rng(2).uniform(-1, 1, (50, 2))
    x, _ = samples(400)
    target = 0.3 + gaussians(x, candidates[[4, 17, 31]], 3.0) @ np.array([0.5, -0.4, 0.7])
    assert set(chosen(gaussians(x, candidates, 3.0), target, 3)) == {4, 17, 31}
    fit = with_centres(x, target, candidates, 3.0, 3)
    assert fit.bias == pytest.approx(0.3, abs=1e-3)
    assert sorted(fit.coefficients) == pytest.approx([-0.4, 0.5, 0.7], abs=1e-3)


# The command


BOARD = "sim_hil/data/boards/three_storeys_1996.toml"


@pytest.fixture(scope="module")
def rig(build: Path) -> LawRig:
    return load_rig(Bench(), ROOT / BOARD, None, 1000)


@pytest.mark.parametrize("kind", list(KINDS_OF_FIT))
def test_a_law_is_imitated(rig: LawRig, kind: str) -> None:
    """A skyhook's current, from stroke and its velocity, in the firmware's integers."""
    x, part = samples(2500)
    values = x * (0.004, 0.2)
    signals = [told for told in STROKES if told in rig.signals]
    made_fit = fit(rig, signals, values, 2.0 * part[:, None], kind, 12, 1)
    assert made_fit.error_A[0] < 0.25 * made_fit.spread_A[0]
    found = demands(made_fit.table, values)[:, 0]
    assert np.sqrt(np.mean((found - 2.0 * part) ** 2)) < 1.2 * made_fit.error_A[0] + 0.01
    text = described(made_fit.table)
    assert "law network, demands current; dampers 1" in text
    assert {"tanh": "12 tanh units", "radial": "12 Gaussians", "rules": "12 normalised"}[
        kind
    ] in text


def test_what_cannot_be_fitted_is_told(rig: LawRig) -> None:
    x, part = samples(50)
    for signals, currents, units, message in (
        (("stroke of nothing", STROKES[1]), part[:, None], 5, "has no 'stroke of nothing'; it has"),
        (STROKES, np.column_stack([part, part]), 5, "2 outputs; board .* has 1 damper"),
        (STROKES, 0.0 * part[:, None], 5, "is the same throughout"),
        (STROKES, part[:, None], 32, "instructions a tick; 5000 are allowed"),
    ):
        kind = "rules" if units == 32 else "tanh"
        with pytest.raises(UsageError, match=message):
            fit(rig, signals, x, currents, kind, units, 1)
    with pytest.raises(UsageError, match="stroke of damper 1 is the same throughout"):
        fit(rig, STROKES, 0.0 * x, part[:, None], "tanh", 5, 1)


def test_the_command_writes_what_the_firmware_takes(
    build: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    x, part = samples(400)
    rows = np.column_stack([x * (0.004, 0.2), 2.0 * part])
    file, out = tmp_path / "samples.csv", tmp_path / "net.table"
    np.savetxt(file, rows, delimiter=",", header="x_m,v_m_s,i_A", comments="")
    inputs = ",".join(
        f"{told}={name}" for told, name in zip(STROKES, ("x_m", "v_m_s"), strict=True)
    )
    words = ["law", "fit", str(file), "--board", str(ROOT / BOARD), "--inputs", inputs]
    assert main([*words, "--output", "i_A", "--kind", "radial", "-o", str(out)]) == 0
    assert "radial: " in capsys.readouterr().out
    assert verdict("network", read_words(out)) == 0
    assert main(["table", "show", str(out)]) == 0
    assert "stroke of damper 1" in capsys.readouterr().out
    assert main([*words, "--output", "j_A", "-o", str(out)]) == 2
    assert "no column 'j_A'; there are: x_m, v_m_s, i_A" in capsys.readouterr().err


def test_a_trackers_network_is_shown(tmp_path: Path, capsys) -> None:
    file = tmp_path / "network.table"
    file.write_bytes(table_bytes(NetworkTrackTable((track_section(),)).words()))
    assert main(["table", "show", str(file)]) == 0
    text = capsys.readouterr().out
    assert "tracker network; dampers 1" in text
    assert "demand of damper 1" in text and "slower than 20 mm/s it counts as that fast" in text


def test_rules_get_the_width_that_suits_rows_they_do_not_know() -> None:
    rng = np.random.default_rng(3)
    x, fresh = rng.uniform(-1.0, 1.0, (2000, 2)), rng.uniform(-1.0, 1.0, (1000, 2))

    def wanted(at: np.ndarray) -> np.ndarray:
        return 0.5 + 0.4 * np.tanh(8.0 * at[:, 0]) * np.abs(at[:, 1])

    broad = with_centres(x, wanted(x), x[:200], 0.5, 12)
    errors = [
        np.sqrt(np.mean((one.parts(fresh) - wanted(fresh)) ** 2))
        for one in (as_rules(broad, x, wanted(x)), best_rules(broad, x, wanted(x)))
    ]
    assert errors[1] < 0.7 * errors[0]
    best = best_rules(broad, x, wanted(x))
    np.testing.assert_array_equal(best.centres, broad.centres)
    for one in (broad, best):
        sums_mA = one.layers(1000.0).sums_mA(fresh)
        np.testing.assert_allclose(sums_mA, 1e3 * one.parts(fresh), atol=0.01)
