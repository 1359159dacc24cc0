"""The rig of the self-tuning model's paper, and what its part of the benchmark measures."""

from dataclasses import replace

import numpy as np
import pytest
from quiesce.damper.online import ADAPTIVE, FROZEN, LAST_FORCE, STOPPED
from quiesce.damper.simulate import simulator
from quiesce_benchmarks.papers import parts
from quiesce_benchmarks.papers.online_changes import (
    CHANGES,
    PUBLISHED,
    followed,
    numbers_of,
    table_of,
    worst,
)
from quiesce_benchmarks.papers.online_protocol import measured
from quiesce_benchmarks.papers.online_rig import (
    FORCE_NOISE_N,
    Rig,
    protocol,
    recorded,
    warmed,
)
from quiesce_benchmarks.part import Effort, all_parts

pytestmark = pytest.mark.usefixtures("build")

TANH = Rig("rd1005_kwok_tanh_smooth")


def played(kind: str, current_A: float):
    return next(t for t in protocol().tests if t.kind == kind and t.current_A == current_A)


def test_recording_is_that_of_the_source_and_of_its_seed() -> None:
    test = played("sine", 1.5)
    one, again, other = (recorded(TANH, test, seed) for seed in (1, 1, 2))
    assert one.rate_Hz == 500.0 and len(one) == 5001 and one.level == 1.5
    assert np.abs(one.disp_m).max() == pytest.approx(5e-3, rel=2e-3)
    assert np.array_equal(one.force_N, again.force_N)
    difference = one.force_N - other.force_N
    assert np.std(difference) == pytest.approx(np.sqrt(2.0) * FORCE_NOISE_N, rel=0.05)


def test_recording_is_the_damper_with_noise_and_nothing_else() -> None:
    record = recorded(TANH, played("chirp", 1.0), 3)
    rest = simulator(TANH.damper())(record) - record.force_N
    # Noise, and what is left of the displacement's noise in its derivative.
    assert FORCE_NOISE_N * 0.9 < np.sqrt(np.mean(rest**2)) < 3.0 * FORCE_NOISE_N


def test_warm_damper_is_weaker_and_its_gas_spring_is_not() -> None:
    cold, hot = TANH.damper(), replace(TANH, temperature_C=80.0).damper()
    ratio = np.divide(hot.parameters["c_N_s_m"], cold.parameters["c_N_s_m"])
    assert ratio == pytest.approx([np.exp(2000.0 * (1 / 353.15 - 1 / 298.15))] * 2)
    assert np.divide(hot.parameters["alpha_N"], cold.parameters["alpha_N"]) == pytest.approx(0.89)
    assert hot.parameters["k_N_m"] == cold.parameters["k_N_m"]
    with pytest.raises(ValueError, match="no factors"):
        warmed(Rig("rd1005_bingham").damper(), 80.0)


def test_every_kind_of_change_is_there() -> None:
    current = [one for one in CHANGES.values() if one.before_A != one.after_A]
    warm = [one for one in CHANGES.values() if one.before.temperature_C]
    swapped = [one for one in CHANGES.values() if one.before.name != one.after.name]
    assert current and warm and swapped
    assert {one.sine_Hz for one in CHANGES.values()} == {None, 2.0}


def test_worst_change_is_the_figure() -> None:
    part = all_parts(parts)["online"]
    assert [name for name, *_ in part.FIGURES] == [
        "online_error_after_change_pct",
        "online_over_best_frozen",
    ]
    assert worst({"a": {"x": 1.0}, "b": {"x": 3.0}, "c": {"x": 2.0}}, "x") == 3.0


@pytest.mark.slow
def test_adaptive_model_beats_the_frozen_ones_after_a_swap() -> None:
    found = numbers_of(followed(CHANGES["damper swapped"], Effort(1, True, None)))  # type: ignore[arg-type]
    assert set(found["models"]) == {ADAPTIVE, *FROZEN, STOPPED, LAST_FORCE, PUBLISHED}
    assert found["over_best_frozen"] < 1.0
    # Frozen models had seen another damper; the file of the new one had not to be fitted.
    assert found["models"][PUBLISHED]["after"] < found["best_frozen_after_pct"]
    assert "damper swapped" in table_of({"damper swapped": found})


@pytest.mark.slow
def test_protocol_has_every_test_and_models_for_it() -> None:
    found, table = measured(Effort(1, True, None))  # type: ignore[arg-type]
    kinds = [(one["kind"], one["current_A"]) for one in found["tests"]]
    assert kinds.count(("sine", 0.0)) == 2 and kinds.count(("chirp", 1.5)) == 1
    for one in found["tests"]:
        assert one["kwok_tanh, fitted"] < 10.0
        assert ("rd1005_bingham, published" in one) == (one["current_A"] == 1.5)
    assert "chirp" in table
