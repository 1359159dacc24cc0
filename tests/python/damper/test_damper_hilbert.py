"""Envelope, frequency and phase as features: causal and published, and the network over them."""

from dataclasses import replace

import numpy as np
import pytest
from learned_data import RATE_Hz, backlash_N, error_of, random_motion, segments_of, sine
from quiesce.damper.data.split import whole
from quiesce.damper.learned import hilbert
from quiesce.damper.learned.hilbert import Quadrature, Settings
from quiesce.network.dense import Network

pytestmark = pytest.mark.usefixtures("build")
SMALL = Settings(hidden=(10,), lags=(0, 2), epochs=8)


def quadrature(records) -> Quadrature:
    segments, scales = segments_of(*records)
    return Quadrature.of(segments, scales, 1.0 / RATE_Hz, 0.3)


@pytest.mark.parametrize("form", ["features", "published"])
def test_both_forms_tell_a_sine(form: str) -> None:
    record = sine(2.5, 4e-3, 0.5, cycles=8.0)
    one = quadrature([record])
    found = getattr(one, form)(record.disp_m, record.velocity_m_s)
    rows = slice(400, 1200)  # settled, and away from the ends
    angle = 2.0 * np.pi * 2.5 * record.time_s[rows]
    assert found[rows, 0] == pytest.approx(2.0 * 4e-3 / one.envelope_m - 1.0, abs=0.35)
    assert found[rows, 0].mean() == pytest.approx(2.0 * 4e-3 / one.envelope_m - 1.0, abs=0.05)
    # x = d cos p and H[x] = d sin p = -v / w.
    assert found[rows, 2] == pytest.approx(np.sin(angle), abs=0.3)
    assert found[rows, 3] == pytest.approx(-np.cos(angle), abs=0.3)
    assert found[rows, 2] ** 2 + found[rows, 3] ** 2 == pytest.approx(1.0)


def test_only_the_causal_form_is_blind_to_the_future() -> None:
    record = random_motion(3)
    one = quadrature([record])
    changed = np.where(record.time_s > 3.0, 0.0, record.disp_m)
    past = record.time_s <= 3.0
    for form, is_same in ((one.features, True), (one.published, False)):
        before = form(record.disp_m, record.velocity_m_s)[past]
        after = form(changed, np.where(past, record.velocity_m_s, 0.0))[past]
        assert np.array_equal(before, after) == is_same


def test_rest_has_no_features() -> None:
    one = quadrature([random_motion(3)])
    zero = np.zeros(50)
    for form in (one.features, one.published):
        assert (form(zero, zero) == 0.0).all()


def test_taps_stand_lag_by_lag() -> None:
    record = random_motion(3)
    segments, scales = segments_of(record)
    one = quadrature([record])
    model = hilbert.fitted(segments, scales, 1, SMALL, 1.0 / RATE_Hz, one.features)
    rows = np.arange(len(record))
    found = hilbert.taps(record, rows, model.box, (0, 2), one.features)
    width = len(model.box) + hilbert.FEATURES
    assert found.shape == (len(record), 2 * width)
    np.testing.assert_array_equal(found[2:, width:], found[:-2, :width])


def test_network_agrees_with_the_library() -> None:
    segments, scales = segments_of(*(random_motion(k, force=backlash_N) for k in (1, 2)))
    model = hilbert.train(segments, scales, 1, SMALL)
    keys = model.to_toml()
    time_s = keys["sample_time_s"]
    one = Quadrature(**keys["quadrature"], sample_time_s=time_s)
    record = random_motion(8, force=backlash_N)
    # The sample before the first step is not in the library's memory: begin at rest.
    names = ("disp_m", "velocity_m_s", "accel_m_s2")
    rest = {name: np.where(record.time_s == 0.0, 0.0, getattr(record, name)) for name in names}
    record = replace(record, **rest)
    box = hilbert.fitted(segments, scales, 1, SMALL, time_s, one.features).box
    network = Network(
        [np.array(layer["weights"]).reshape(layer["units"], -1) for layer in keys["layer"]],
        [np.array(layer["biases"]) for layer in keys["layer"]],
    )
    inputs = hilbert.taps(record, np.arange(len(record)), box, keys["lags"], one.features)
    expected = network(inputs)[:, 0]
    found = model.simulate(record) / keys["force_scale_N"]
    np.testing.assert_allclose(found[3:], expected[3:], atol=1e-9)


def test_features_help_a_damper_that_follows_the_frequency() -> None:
    """A spring whose stiffness follows the frequency: without memory, displacement and velocity do
    not tell it."""

    def record(freq_Hz: float):
        made = sine(freq_Hz, 4e-3, 0.5, cycles=6.0 * freq_Hz)
        return replace(made, force_N=1000.0 * freq_Hz * made.disp_m)

    segments, scales = segments_of(*(record(freq_Hz) for freq_Hz in (1.0, 2.0, 3.0, 4.0)))
    test = [whole(record(2.5))]
    settings = Settings(hidden=(12,), lags=(0,), epochs=30)
    model = hilbert.train(segments, scales, 1, settings)
    plain = hilbert.fitted(segments, scales, 1, settings, 1.0 / RATE_Hz, None)
    error = plain.simulate(test[0].record) - test[0].record.force_N
    without = np.linalg.norm(error) / np.linalg.norm(test[0].record.force_N)
    assert error_of(model, test) < 0.15 < without


def test_training_is_the_same_for_the_same_seed() -> None:
    segments, scales = segments_of(random_motion(1, 2.0))
    first = hilbert.train(segments, scales, 1, SMALL).to_toml()
    assert hilbert.train(segments, scales, 1, SMALL).to_toml() == first
    assert hilbert.train(segments, scales, 2, SMALL).to_toml() != first
