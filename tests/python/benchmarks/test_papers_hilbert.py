"""The part of `benchmark papers` about a network over envelope, frequency and phase."""

import conftest  # noqa: F401
import numpy as np
import pytest
from quiesce_benchmarks.papers import parts
from quiesce_benchmarks.papers.parts import hilbert
from quiesce_benchmarks.part import Effort, all_parts

pytestmark = pytest.mark.usefixtures("build")


def test_nothing_that_is_judged_was_trained_on() -> None:
    truth = hilbert.truths()[1]
    train, test = hilbert.sines(truth, 3), hilbert.held_out(truth, 3)
    assert len({one.record.name for one in test}) == len(test) == 5
    for one in test:
        same = [
            np.allclose(one.record.disp_m[: len(other)], other.record.disp_m)
            for other in train
            if len(other) <= len(one)
        ]
        assert same and not any(same)
        assert np.abs(one.record.disp_m).max() <= truth.damper.stroke_m
        assert 0.0 <= one.record.command.min() and one.record.command.max() <= truth.most_A


def test_truths_remember() -> None:
    for truth in hilbert.truths():
        assert truth.damper.kernel_row()[0].states > 0 and truth.damper.rig["rise_s"] > 0.0


@pytest.mark.slow
def test_all_forms_have_a_figure(tmp_path) -> None:
    assert all_parts(parts)["hilbert"] is hilbert
    found = hilbert.measure(Effort(1, True, tmp_path))
    assert set(found.values) == {name for name, *_ in hilbert.FIGURES}
    assert all(0.0 < value < 60.0 for value in found.values.values())
    assert set(found.reported) == {truth.damper.name for truth in hilbert.truths()}
