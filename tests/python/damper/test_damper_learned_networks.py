"""Networks: gradients, training, free running, and the same forces in numpy and in C++."""

from dataclasses import replace

import numpy as np
import pytest
from learned_data import backlash_N, error_of, random_motion, segments_of, sine
from quiesce.base.errors import UsageError
from quiesce.damper import library
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.learned import feed_forward, hysteresis_network, recurrent
from quiesce.damper.learned.elements import Elements
from quiesce.damper.learned.inputs import Box
from quiesce.damper.learned.sampled import default_lags, delayed
from quiesce.damper.library import Scales
from quiesce.damper.model_file import DamperModel
from quiesce.network.dense import Network, fit

SMALL = hysteresis_network.Settings(
    hidden=(16,), members=2, epochs=25, decays=(0.1,), search_epochs=5
)


def with_memory(*seeds: int, current_A: float = 0.5):
    return [random_motion(seed, current_A=current_A, force=backlash_N) for seed in seeds]


# Gradients


def test_network_gradients_are_those_of_differences():
    rng = np.random.default_rng(1)
    network = Network.random((3, 5, 4, 2), rng)
    inputs, by_output = rng.normal(size=(6, 3)), rng.normal(size=(6, 2))
    gradients, by_inputs = network.backward(network.forward(inputs), by_output)

    def cost() -> float:
        return float(np.sum(network(inputs) * by_output))

    for values, gradient in zip([*network.values, inputs], [*gradients, by_inputs], strict=True):
        for index in np.ndindex(values.shape):
            kept = values[index]
            values[index] = kept + 1e-6
            above = cost()
            values[index] = kept - 1e-6
            below = cost()
            values[index] = kept
            assert gradient[index] == pytest.approx((above - below) / 2e-6, abs=1e-7)


def test_recurrent_gradients_go_through_time():
    rng = np.random.default_rng(2)
    network = Network.random((2 + 2, 4, 1), rng)
    inputs, force = rng.normal(size=(3, 9, 2)), rng.normal(size=(3, 9))
    _, gradients = recurrent.window_gradient(network, inputs, force, (1, 3))
    for values, gradient in zip(network.values, gradients, strict=True):
        for index in np.ndindex(values.shape):
            kept = values[index]
            values[index] = kept + 1e-6
            above, _ = recurrent.window_gradient(network, inputs, force, (1, 3))
            values[index] = kept - 1e-6
            below, _ = recurrent.window_gradient(network, inputs, force, (1, 3))
            values[index] = kept
            assert gradient[index] == pytest.approx((above - below) / 2e-6, abs=1e-7)


def test_network_learns_a_curve():
    rng = np.random.default_rng(3)
    inputs = rng.uniform(-1, 1, (800, 1))
    network = Network.random((1, 12, 1), rng)
    fit(network, inputs, np.sin(3.0 * inputs), rng, epochs=400)
    at = np.linspace(-0.9, 0.9, 50)[:, None]
    assert np.abs(network(at) - np.sin(3.0 * at)).max() < 0.1


# Feed-forward and recurrent


def test_static_network_agrees_with_the_library():
    segments, scales = segments_of(sine(2.5, 5e-3, 0.0), sine(2.5, 5e-3, 1.0))
    model = feed_forward.train(segments, scales, 1, feed_forward.Settings(lags=()))
    assert error_of(model, segments) < 0.1
    keys = model.to_toml()
    network = network_of(keys["layer"])
    box = box_of(keys)
    record = random_motion(9, 1.0, 0.4)
    expected = keys["force_scale_N"] * network(box.scaled(box.picked(record)))[:, 0]
    np.testing.assert_allclose(model.simulate(record), expected, atol=1e-10 * scales.force_N)


def network_of(layers: list[dict]) -> Network:
    return Network(
        [np.array(one["weights"]).reshape(one["units"], -1) for one in layers],
        [np.array(one["biases"]) for one in layers],
    )


def box_of(keys: dict) -> Box:
    names = [key for key in ("current_A", "displacement_m", "velocity_m_s") if key in keys]
    return Box(tuple(names), *np.array([keys[key]["range"] for key in names]).T)


@pytest.mark.parametrize("is_recurrent", [False, True])
def test_sampled_networks_agree_with_the_library(is_recurrent):
    segments, scales = segments_of(*with_memory(1))
    if is_recurrent:
        settings = recurrent.Settings(epochs=5, free_steps=20, lags=(0, 2))
        model = recurrent.train(segments, scales, 1, settings)
    else:
        model = feed_forward.train(segments, scales, 1, feed_forward.Settings(epochs=5))
    keys = model.to_toml()
    record = with_memory(8)[0]
    # The sample before the first step is not in the library's memory: begin at rest.
    record = replace(record, **at_rest_first(record))
    inputs = delayed(box_of(keys).picked(record), box_of(keys), keys["lags"])
    network = network_of(keys["layer"])
    if is_recurrent:
        expected = recurrent.free_run(network, inputs, keys["feedback"])
    else:
        expected = network(inputs)[:, 0]
    forces = model.simulate(record) / keys["force_scale_N"]
    first = 400 if is_recurrent else max(keys["lags"]) + 1
    np.testing.assert_allclose(forces[first:], expected[first:], atol=1e-10 if first < 99 else 1e-6)


def at_rest_first(record):
    names = ("disp_m", "velocity_m_s", "accel_m_s2")
    return {name: np.where(record.time_s == 0.0, 0.0, getattr(record, name)) for name in names}


@pytest.mark.slow
def test_a_memory_needs_lags_and_feedback_helps_free_running():
    records = with_memory(1, 2, 3)
    segments, scales = segments_of(*records[:2])
    held_out = [whole(records[2])]
    static = feed_forward.train(segments, scales, 1, feed_forward.Settings(lags=()))
    settings = recurrent.Settings(epochs=15, free_steps=300)
    own = recurrent.train(segments, scales, 1, settings)
    assert error_of(own, held_out) < 0.75 * error_of(static, held_out)
    assert "free-running" in own.notes[0]


def test_default_lags_reach_thirty_milliseconds():
    assert default_lags(0.001) == (0, 1, 2, 4, 8, 16)
    assert default_lags(0.05) == (0, 1)


# Networks over hysteresis elements


def test_elements_are_integrated_as_in_the_library():
    record = with_memory(4)[0]
    command = np.where(record.time_s % 0.5 < 0.2, 1.0, 0.2)
    record = replace(record, command=command)
    elements = Elements((0.01, 0.03), (0.02, 0.03), (0.004,), (0.003, 0.006), (2e-4, 2e-3))
    steps = 3
    states = elements.states([record, record], steps)
    np.testing.assert_array_equal(states[0], states[1])
    for state in range(elements.count):
        skip = np.zeros(3 + elements.count)
        skip[3 + state] = 1.0
        forces = Passing(elements, skip).simulate_steps(record, steps)
        np.testing.assert_allclose(forces, states[0][:, state], atol=1e-12)


class Passing:
    """A file whose force is one of the states."""

    def __init__(self, elements: Elements, skip: np.ndarray) -> None:
        count = len(skip)
        parameters = {
            "force_scale_N": 1.0, "current_scale_A": 1.0, "field_order": 0, "uses_accel": True,
            **elements.tables(),
            "feature_means": [0.0] * count, "feature_scales": [1.0] * count, "clip": 1000.0,
            "skip": skip.tolist(),
            "member": [{"layer": [{"units": 1, "weights": [0.0] * count, "biases": [0.0]}]}],
        }  # fmt: skip
        self._model = DamperModel("states", "hysteresis_network", 1.0, 1.0, parameters)

    def simulate_steps(self, record, steps: int) -> np.ndarray:
        return hysteresis_network.base_file(self._model).simulate(library.motion(record), steps)


@pytest.mark.slow
def test_hysteresis_network_learns_a_memory_and_forgets_no_current():
    train = [one for at in (0.0, 0.5, 1.0) for one in with_memory(1, 2, current_A=at)]
    segments, scales = segments_of(*train)
    model = hysteresis_network.train(segments, scales, 1, SMALL)
    held_out = [whole(one) for one in with_memory(7, current_A=0.5)]
    static = feed_forward.train(segments, scales, 1, feed_forward.Settings(lags=(), epochs=20))
    assert error_of(model, held_out) < 0.12
    assert error_of(model, held_out) < 0.5 * error_of(static, held_out)


@pytest.mark.slow
def test_hysteresis_network_agrees_with_numpy():
    segments, scales = segments_of(*with_memory(1))
    model = hysteresis_network.train(segments, scales, 1, SMALL)
    elements = hysteresis_network.elements_for(segments, None)
    law = hysteresis_network.field_for(segments)
    prepared = hysteresis_network.prepare(segments, elements, law, scales, SMALL)
    keys = model.to_toml()
    features = prepared.examples.features
    heads = features @ np.array(keys["skip"]).reshape(-1, features.shape[1]).T
    for member in keys["member"]:
        heads = heads + network_of(member["layer"])(features) / len(keys["member"])
    expected = scales.force_N * np.sum(heads * prepared.examples.powers, axis=1)
    forces = model.simulate(segments[0].record)[-len(expected) :]
    np.testing.assert_allclose(forces, expected, atol=1e-10 * scales.force_N)


@pytest.mark.slow
def test_grey_box_stands_on_its_base():
    segments, scales = segments_of(*with_memory(1, 2))
    kwok = {"c_N_s_m": 800.0, "alpha_N": 400.0, "beta_s_m": 20.0, "delta": 0.5}
    values = {
        one.name: kwok.get(one.name, max(one.min, 0.0))
        for one in library.model("kwok_tanh").parameters
    }
    base = DamperModel("base", "kwok_tanh", 1.0, 1.0, values)
    model = hysteresis_network.train(segments, scales, 1, replace(SMALL, base=base, epochs=10))
    held_out = [whole(one) for one in with_memory(7)]
    assert model.to_toml()["base"]["model"] == "kwok_tanh"
    assert error_of(model, held_out) < 0.2


@pytest.mark.slow
def test_a_base_with_a_wrong_parameter_is_named():
    segments, scales = segments_of(*with_memory(1))
    base = DamperModel("base", "kwok_tanh", 1.0, 1.0, {"stiffness": 1.0})
    with pytest.raises(UsageError, match="parameters"):
        hysteresis_network.train(segments, scales, 1, replace(SMALL, base=base))


def test_targets_of_averaged_forces_end_at_the_force_itself():
    record = replace(with_memory(1)[0], average_samples=25)
    force = record.force_N / 1000.0
    rows = slice(0, len(record))
    member = hysteresis_network.Corrector(
        Network([np.zeros((1, 1))], [np.zeros(1)]), np.ones((1, 1))
    )
    examples = hysteresis_network.Examples(
        force[:, None], np.ones((len(force), 1)), record.averaged(force), [(rows, record)]
    )
    assert np.abs(examples.target - force).max() > 0.01
    np.testing.assert_allclose(hysteresis_network.sharpened(member, examples), force, atol=1e-12)


def test_mixed_commands_are_refused():
    record = with_memory(1)[0]
    volts = replace(record, command_unit="V")
    with pytest.raises(UsageError, match="current and some a voltage"):
        hysteresis_network.train([whole(record), whole(volts)], Scales.of([whole(record)]))


@pytest.mark.slow
def test_a_part_of_a_record_is_learned_from_its_rows_only():
    record = with_memory(1)[0]
    spoilt = record.force_N.copy()
    spoilt[2000:] = 1e6
    segment = [Segment(replace(record, force_N=spoilt), 0, 2000)]
    scales = Scales.of([whole(record)])
    expected = hysteresis_network.train([Segment(record, 0, 2000)], scales, 1, SMALL)
    assert hysteresis_network.train(segment, scales, 1, SMALL).to_toml() == expected.to_toml()


def test_a_grey_box_keeps_the_field_law_of_its_base() -> None:
    """In a file the base has its [field], too: the same force as in training."""
    from quiesce.damper.learned.hysteresis_network import base_section
    from quiesce.damper.library import RIG, model
    from quiesce.damper.model_file import from_row

    one = model("viscoplastic_1")
    orders = [1] * len(one.parameters)
    values = [parameter.search_low or 1.0 for parameter in one.parameters]
    rig = dict.fromkeys(RIG, 0.0) | {"field_exponent": 1.5, "field_ref_A": 2.0}
    base = from_row(one, orders, np.array([*values, *rig.values()]), "base", 1.0, 1.0)
    assert base_section(base)["field"] == {"exponent": 1.5, "saturation": 0.0, "reference_A": 2.0}
    plain = from_row(one, orders, np.array([*values, *[0.0] * len(RIG)]), "base", 1.0, 1.0)
    assert "field" not in base_section(plain)
