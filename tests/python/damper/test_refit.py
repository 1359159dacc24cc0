"""Refits that leave a fold out: as good as fits from scratch, by what the fold can tell."""

from dataclasses import replace

import numpy as np
import pytest
from learned_data import sine
from quiesce.damper.candidates import Choice, parametric_candidates, rig_of, setting_of
from quiesce.damper.data.folds import CURRENT, folds_of
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.fit_model import Refit, RigFit
from quiesce.damper.task import Plan

pytestmark = pytest.mark.usefixtures("build")
KWOK = parametric_candidates()["kwok_tanh"]
NETWORK = parametric_candidates()["viscoplastic_1"]
PLAN = Plan(["kwok_tanh"], Choice(rig=()), quick=True)


def rig_tests(currents_A=(0.0, 0.5, 1.0)) -> list[Segment]:
    rng = np.random.default_rng(1)
    found = []
    for freq_Hz, size_m in ((1.0, 8e-3), (2.5, 4e-3)):
        for level in currents_A:
            record = sine(freq_Hz, size_m, level, cycles=3.0, rate_Hz=100.0)
            noise_N = rng.normal(0.0, 5.0, len(record))
            found.append(whole(replace(record, force_N=record.force_N + noise_N)))
    return found


def fitted(rows: list[Segment]):
    fit = RigFit(KWOK, rows, PLAN, None, 1e6, lambda *_: None)
    return fit.fitted(setting_of(KWOK, rows, PLAN.choice))


def test_refit_is_as_good_as_a_fit_from_scratch() -> None:
    segments = rig_tests()
    whole_fit = fitted(segments)
    for fold in folds_of(segments):
        problem, again = Refit(KWOK, fold, PLAN, 1e6, lambda *_: None).of(*whole_fit)
        assert again.is_complete
        assert again.error <= 1.02 * fitted(fold.fit)[1].error, fold.left_out
        levels = 2 if fold.kind == CURRENT else 3
        assert problem.setting.nodes_A == pytest.approx(np.linspace(0.0, 1.0, levels))


def test_a_fit_that_goes_on_from_a_refit_counts_what_that_took() -> None:
    """The fit to everything is spoilt, so that the refit's values lead to a better one."""
    segments = rig_tests()
    problem, found = fitted(segments)
    middle = problem.values_from(np.full((1, len(problem.nonlinear)), 0.5))
    start, errors = problem.project(middle)
    spoilt = replace(found, values=start[0], error=float(errors[0]))
    fit = RigFit(KWOK, segments, PLAN, None, 1e6, lambda *_: None)
    again = fit.gone_on_from([(problem, found)], (problem, spoilt))
    assert again.error < spoilt.error
    assert again.evaluations == problem.evaluations > found.evaluations


def test_refit_that_has_no_time_is_marked_and_no_worse_than_its_start() -> None:
    segments = rig_tests()
    whole_problem, found = fitted(segments)
    fold = folds_of(segments)[-1]
    problem, again = Refit(KWOK, fold, PLAN, 0.0, lambda *_: None).of(whole_problem, found)
    assert not again.is_complete and np.isfinite(problem.error(again.values))
    assert problem.error(again.values) == pytest.approx(again.error)


def test_two_levels_tell_nothing_of_saturation() -> None:
    two, three = rig_tests((0.0, 1.0)), rig_tests()
    assert "field_saturation" not in rig_of(NETWORK, two, Choice())
    assert "field_saturation" in rig_of(NETWORK, three, Choice())
    assert setting_of(NETWORK, two, Choice()).nodes_A == (0.0, 1.0)
