"""Least-squares Bouc-Wen identification on synthetic tests with a known truth."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record
from quiesce.damper.fit.least_squares_bouc_wen import (
    BoucWenFit,
    Sines,
    fit,
    fit_currents,
)
from scipy.integrate import solve_ivp

TRUTH = BoucWenFit(
    current=1.0, c_N_s_m=2500.0, k_N_m=6000.0, A_N_m=1.6e6, beta=10.87, gamma=25.37, n=1.6, f0_N=0.0
)
AMPLITUDE_m = 0.005
RATE_Hz = 2000.0
CYCLES = 11


@cache
def hysteresis(truth: BoucWenFit, phases: int) -> np.ndarray:
    """h over CYCLES cycles of a sine, `phases` points a cycle: independent of library and rate."""

    def rate(angle: float, h: np.ndarray) -> np.ndarray:
        v = AMPLITUDE_m * np.cos(angle)
        size = np.abs(h) ** truth.n
        loading = truth.beta + truth.gamma * np.sign(v * h)
        return v * (truth.A_N_m - loading * size)

    angles = 2.0 * np.pi * np.arange(CYCLES * phases + 1) / phases
    # Piece by piece, so that no step passes over a reversal.
    return solve_ivp(
        rate, (0.0, angles[-1]), [0.0], t_eval=angles, rtol=1e-9, atol=1e-6, max_step=0.02
    ).y[0]


def record(
    truth: BoucWenFit, freq_Hz: float, shift_m: float, noise: float = 0.0, seed: int = 0
) -> Record:
    """A test; noise: standard deviation over the effective value of the force."""
    phases = round(RATE_Hz / freq_Hz)
    h = hysteresis(truth, phases)
    time_s = np.arange(len(h)) / RATE_Hz
    w = 2.0 * np.pi * freq_Hz
    disp = shift_m + AMPLITUDE_m * np.sin(w * time_s)
    velocity = AMPLITUDE_m * w * np.cos(w * time_s)
    force = truth.c_N_s_m * velocity + truth.k_N_m * disp + h + truth.f0_N
    deviation = noise * np.sqrt(np.mean(force**2))
    force = force + np.random.default_rng(seed).normal(0.0, deviation, len(force))
    accel = -AMPLITUDE_m * w**2 * np.sin(w * time_s)
    current = np.full(len(h), truth.current)
    return Record(f"{freq_Hz:g}Hz", RATE_Hz, time_s, disp, velocity, accel, force, current, "A")


def sines_of(truth: BoucWenFit, noise: float = 0.0, seed: int = 0) -> Sines:
    return Sines(
        record(truth, 1.0, 0.0, noise, 3 * seed),
        record(truth, 1.0, 0.002, noise, 3 * seed + 1),
        record(truth, 2.0, 0.0, noise, 3 * seed + 2),
    )


def deviations(found: BoucWenFit, truth: BoucWenFit = TRUTH) -> dict[str, float]:
    names = ("c_N_s_m", "k_N_m", "A_N_m", "beta", "gamma", "n")
    return {name: getattr(found, name) / getattr(truth, name) - 1.0 for name in names}


def test_without_noise_every_parameter_is_found() -> None:
    for name, deviation in deviations(fit(sines_of(TRUTH))).items():
        assert abs(deviation) < 0.002, name


def test_the_steps_alone_come_near() -> None:
    for name, deviation in deviations(fit(sines_of(TRUTH), is_refined=False)).items():
        assert abs(deviation) < 0.03, name


# One and a half of the largest deviation among 30 seeds.
@pytest.mark.parametrize(
    ("noise", "limits"),
    [
        (0.002, {"c_N_s_m": 0.002, "k_N_m": 0.005, "A_N_m": 0.002, "n": 0.003}
         | dict.fromkeys(("beta", "gamma"), 0.035)),
        (0.01, {"c_N_s_m": 0.007, "k_N_m": 0.022, "A_N_m": 0.005, "n": 0.013}
         | dict.fromkeys(("beta", "gamma"), 0.18)),
    ],
)  # fmt: skip
def test_noise_costs_little(noise: float, limits: dict[str, float]) -> None:
    found = [deviations(fit(sines_of(TRUTH, noise, seed))) for seed in range(8)]
    for name, limit in limits.items():
        assert max(abs(one[name]) for one in found) < limit, name
        assert abs(np.mean([one[name] for one in found])) < 0.5 * limit, name


@pytest.mark.slow
def test_offset_and_downward_shift_change_nothing_else() -> None:
    still, shifted, faster = (
        record(replace(TRUTH, f0_N=120.0), freq, shift, 0.0)
        for freq, shift in ((1.0, 0.0), (1.0, -0.0015), (4.0, 0.0))
    )
    found = fit(Sines(still, shifted, faster))
    assert found.f0_N == pytest.approx(120.0, abs=1.0)
    assert max(map(abs, deviations(found).values())) < 0.002


@pytest.mark.slow
def test_beta_may_be_negative() -> None:
    truth = replace(TRUTH, beta=-6.0)
    found = fit(sines_of(truth))
    assert found.beta == pytest.approx(-6.0, rel=0.005)
    assert found.gamma == pytest.approx(truth.gamma, rel=0.005)


@pytest.mark.slow
def test_common_n_and_polynomials_over_the_current() -> None:
    def truth(current: float) -> BoucWenFit:
        return replace(
            TRUTH, current=current, c_N_s_m=1500.0 + 800.0 * current, A_N_m=8e5 * (1.0 + current)
        )

    fits, laws = fit_currents([sines_of(truth(i)) for i in (0.5, 1.0, 1.5)], degree=1)
    assert {one.n for one in fits} == {float(laws["n"][0])}
    assert laws["n"][0] == pytest.approx(1.6, rel=0.002)
    assert laws["c_N_s_m"] == pytest.approx([1500.0, 800.0], rel=0.002)
    assert laws["A_N_m"] == pytest.approx([8e5, 8e5], rel=0.002)
    assert laws["gamma"][0] == pytest.approx(25.37, rel=0.01)


def test_too_few_currents_for_the_polynomial() -> None:
    with pytest.raises(UsageError, match="3 currents or more, found 1"):
        fit_currents([sines_of(TRUTH)])


def test_forms_of_the_library_have_the_same_slopes() -> None:
    z_form = TRUTH.bouc_wen()
    unit_form = TRUTH.normalised()
    for part in (0.1, 0.5, 0.95):
        h = part * TRUTH.largest_h_N
        for side in (-1.0, 1.0):
            slope = TRUTH.A_N_m - (TRUTH.beta + side * TRUTH.gamma) * h**TRUTH.n
            z = h / z_form["alpha_N_m"]
            loss = (z_form["beta_1_mn"] + side * z_form["gamma_1_mn"]) * z ** z_form["n"]
            assert z_form["alpha_N_m"] * (z_form["A"] - loss) == pytest.approx(slope)
            sigma = unit_form["sigma"]
            loss = (side * sigma - (sigma - 1.0)) * part ** unit_form["n"]
            rate = unit_form["kw_N"] * unit_form["rho_1_m"] * (1.0 - loss)
            assert rate == pytest.approx(slope)


def spoilt(which: str, **changes: object) -> Sines:
    sines = sines_of(TRUTH)
    return replace(sines, **{which: replace(getattr(sines, which), **changes)})


def with_force(change: float) -> Sines:
    sines = sines_of(TRUTH)
    return Sines(
        *(replace(one, force_N=change * one.force_N)
          for one in (sines.still, sines.shifted, sines.faster))
    )  # fmt: skip


def viscous() -> Sines:
    sines = sines_of(TRUTH)
    return Sines(
        *(replace(one, force_N=100.0 * one.velocity_m_s + 5.0 * one.disp_m)
          for one in (sines.still, sines.shifted, sines.faster))
    )  # fmt: skip


def changing() -> np.ndarray:
    return np.linspace(0.0, 2.0, len(sines_of(TRUTH).still))


def two_tones() -> np.ndarray:
    still = sines_of(TRUTH).still
    return still.disp_m + 0.002 * np.sin(17.0 * still.time_s)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sines(*[sines_of(TRUTH).still] * 3), "about another displacement"),
        (lambda: replace(sines_of(TRUTH), faster=sines_of(TRUTH).still), "frequency that differs"),
        (lambda: replace(sines_of(TRUTH), shifted=record(TRUTH, 2.0, 0.002)), "the frequency of"),
        (lambda: spoilt("still", disp_m=2.0 * sines_of(TRUTH).still.disp_m), "the amplitude of"),
        (lambda: spoilt("faster", command=changing()), "a constant current"),
        (lambda: spoilt("faster", command=sines_of(TRUTH).faster.command + 0.5), "different curr"),
        (lambda: spoilt("still", disp_m=two_tones()), "a sine of constant amplitude"),
        (lambda: spoilt("still", disp_m=np.zeros(len(changing()))), "a sine of the displacement"),
        (lambda: replace(sines_of(TRUTH), still=sines_of(TRUTH).still.rows(0, 1500)), "two cycles"),
        (lambda: with_force(-1.0), "--flip-force"),
        (viscous, "no hysteretic force"),
    ],
)  # fmt: skip
def test_what_it_cannot_use_is_named(make, words: str) -> None:
    with pytest.raises(UsageError, match=words) as error:
        fit(make())
    assert "\n" not in str(error.value)
