"""The firmware's integers beside float64, on signals that cover at least half of their range."""

import numpy as np
import pytest
from quiesce.law.block import System, compile_system
from quiesce.law.forms.friction import FrictionSection, FrictionTable
from quiesce.law.forms.polynomial import PolynomialSection, PolynomialTable, term
from quiesce.law.forms.signs import SignsSection, SignsTable, combination
from quiesce.law.signal import Input, signal
from quiesce_benchmarks.laws.firmware_laws import demands

TICKS = 20000


def motion(columns: int, seed: int) -> np.ndarray:
    """Sines of all kinds of speeds, and noise; within 1."""
    rng = np.random.default_rng(seed)
    t = np.arange(TICKS)[:, None] / 1000.0
    tones = sum(
        rng.uniform(0.2, 0.5, columns)
        * np.sin(2 * np.pi * rng.uniform(0.2, 30, columns) * t + rng.uniform(0, 6, columns))
        for _ in range(3)
    )
    return np.clip(tones + 0.02 * rng.standard_normal((TICKS, columns)), -1, 1)


def full_scale_error(table, values: np.ndarray, exact: np.ndarray) -> float:
    found = demands(table, values)
    assert np.isfinite(found).all()
    covered = np.ptp(exact) / 2
    return float(np.abs(found - exact).max() / covered)


def oscillator(freq_Hz: float, damping_ratio: float) -> System:
    w = 2 * np.pi * freq_Hz
    a = np.array([[0.0, 1.0], [-w * w, -2 * damping_ratio * w]])
    return System(a, np.array([[0.0], [1.0]]), np.array([[w * w, 0.0]]), np.zeros((1, 1)))


def exact_forces(system: System, values: np.ndarray, limit_N: float) -> np.ndarray:
    """Of the continuous system itself, its inputs held for a tick."""
    import scipy.signal

    a, b, c, d, _ = scipy.signal.cont2discrete((system.a, system.b, system.c, system.d), 1e-3)
    x, out = np.zeros(len(a)), []
    for now in values:
        out.append(np.clip(c @ x + d @ now, -limit_N, limit_N))
        x = a @ x + b @ now
    return np.array(out)


@pytest.mark.parametrize(
    ("freq_Hz", "damping_ratio"), [(1.0, 0.001), (0.05, 0.5), (10.0, 0.02), (200.0, 0.3)]
)
def test_linear_follows_the_system(freq_Hz: float, damping_ratio: float) -> None:
    """A lightly damped mode of 1 Hz at 1 kHz among them, driven at its resonance."""
    inputs = [Input.of(signal("acceleration"), 10.0)]
    system = oscillator(freq_Hz, damping_ratio)
    made = compile_system(system, inputs, [(0, 1e5)], 1000)
    assert 5.9 < made.headroom_dB < 6.1
    assert made.pole_error < 1e-4 and made.gain_error < 1e-4
    t = np.arange(TICKS)[:, None] / 1000.0
    values = np.where(t < 15, 9.9 * np.sin(2 * np.pi * freq_Hz * t), 0.0)
    exact = exact_forces(system, values, 1e5)
    found = demands(made.table, values)[:, :1]
    assert np.abs(exact).max() > 5.0
    assert np.abs(found - exact).max() < 0.002 * np.abs(exact).max()
    assert made.table.forces_N(values)[:, :1] == pytest.approx(exact, abs=np.abs(exact).max() / 500)


def test_linear_of_many_states_and_limits() -> None:
    rng = np.random.default_rng(3)
    blocks = [oscillator(f, 0.05).a for f in (0.7, 3.0, 11.0, 40.0)]
    change = rng.normal(size=(8, 8))
    a = (
        change
        @ np.block(
            [[blocks[i] if i == j else np.zeros((2, 2)) for j in range(4)] for i in range(4)]
        )
        @ np.linalg.inv(change)
    )
    system = System(a, rng.normal(size=(8, 3)), rng.normal(size=(2, 8)), rng.normal(size=(2, 3)))
    names = ("velocity", "stroke", "force")
    inputs = [Input.of(signal(name, 0), 1.0) for name in names]
    values = motion(3, 4)
    peak = np.abs(exact_forces(system, values, 1e9)).max(axis=0)
    rows = [(0, 0.6 * peak[0]), (1, 2 * peak[1])]
    made = compile_system(system, inputs, rows, 1000)
    exact = exact_forces(system, values, 1e9)
    exact = np.clip(exact, -0.6 * peak[0], 0.6 * peak[0]) * [1, 0] + exact * [0, 1]
    found = demands(made.table, values)
    assert not found[:, 2:].any()
    for i in range(2):
        assert np.abs(found[:, i] - exact[:, i]).max() < 0.01 * np.abs(exact[:, i]).max()


def test_no_input_takes_a_state_out_of_its_range() -> None:
    """The worst input that there is, by the signs of the impulse response, and it nearly does."""
    system = oscillator(2.0, 0.02)
    inputs = [Input.of(signal("acceleration"), 10.0)]
    made = compile_system(system, inputs, [(0, 1e5)], 1000)
    a, b, _, _ = made.table.matrices()
    response, x = [], b[:, 0]
    for _ in range(TICKS):
        response.append(x)
        x = a @ x
    worst = 10.0 * np.sign(np.array(response)[::-1, :1])
    found = demands(made.table, np.vstack([worst, worst]))
    assert np.isfinite(found).all()
    assert made.headroom_dB == pytest.approx(20 * np.log10(2), abs=0.1)


@pytest.mark.parametrize(
    ("system", "message"),
    [
        (oscillator(1.0, 0.0), "not stable"),
        (oscillator(1.0, -0.1), "not stable"),
        (
            System(np.zeros((1, 1)), np.ones((1, 1)), np.ones((1, 1)), np.zeros((1, 1))),
            "not stable",
        ),
        (oscillator(1.0, 1e-9), "fades too slowly"),
        (
            System(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.full((1, 1), 1e14)),
            "beyond 2",
        ),
    ],
)
def test_what_no_range_holds_is_refused(system: System, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        compile_system(system, [Input.of(signal("acceleration"), 10.0)], [(0, 1e5)], 1000)


def test_signs_agree_but_where_rounding_decides() -> None:
    inputs = tuple(Input.of(signal(name), 1.0) for name in ("velocity", "stroke velocity"))
    pair = (combination(inputs, [1.0, 0.3], 0.02), combination(inputs, [0.0, -1.0], 0.01))
    table = SignsTable((SignsSection(inputs, pair, 100, (0, 700, 1400, 2100)),))
    values = motion(2, 6)
    found, exact = demands(table, values), table.currents_A(values)
    assert len(np.unique(exact[:, 0])) >= 4
    assert np.mean(np.abs(found - exact) > 1e-9) < 1e-3


def test_friction_follows_its_peaks() -> None:
    table = FrictionTable(
        (
            FrictionSection(5000, 100_000_000, 3_000_000, 20_000, 3),
            FrictionSection(900, 0, 10**9, 0, 1),
        )
    )
    values = motion(4, 7)
    exact = table.forces_N(values)
    for i in range(2):
        error = np.abs(demands(table, values)[:, i] - exact[:, i])
        assert np.mean(error > 0.01 * np.abs(exact[:, i]).max()) < 1e-3


def test_polynomial_within_a_part_in_a_thousand() -> None:
    inputs = (Input.of(signal("stroke"), 1.0), Input.of(signal("stroke velocity"), 1.0))
    terms = tuple(
        term(inputs, powers, factor)
        for powers, factor in [((0, 0), 0.3), ((1, 0), 2.0), ((3, 1), -4.0), ((0, 3), 5.0)]
    )
    table = PolynomialTable((PolynomialSection(inputs, (True, False), terms),))
    values = motion(2, 8)
    assert full_scale_error(table, values, table.currents_A(values)) < 0.001


def test_words_cover_what_a_law_can_be_given() -> None:
    """Beyond the limits of its inputs a law is as at them."""
    inputs = (Input.of(signal("stroke velocity"), 0.5),)
    table = PolynomialTable((PolynomialSection(inputs, (True,), (term(inputs, (1,), 2.0),)),))
    found = demands(table, np.array([[0.25], [0.5], [-0.6], [900.0]]))
    assert found[:, 0] == pytest.approx([0.5, 1.0, 1.0, 1.0], abs=0.0011)
