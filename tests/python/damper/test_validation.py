"""Folds of the validation, what they say of a model, and the band about its force."""

from dataclasses import replace

import numpy as np
import pytest
from learned_data import random_motion, sine
from quiesce.damper.band import Band, LeftOut, band_of, coverage, levels_along
from quiesce.damper.data.folds import AMPLITUDE, CURRENT, MOTION, QUARTERS, folds_of
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, records_in, whole
from quiesce.damper.validated import validated
from quiesce.damper.validation import (
    Blocks,
    FoldScore,
    blocks_of,
    errors_by_kind,
    fold_score,
    forces_on,
    overall,
    share_before,
)


def rig_tests(currents_A, motions, rate_Hz: float = 100.0) -> list[Segment]:
    """motions: pairs of Hz and m."""
    return [
        whole(sine(freq_Hz, size_m, level, rate_Hz=rate_Hz))
        for freq_Hz, size_m in motions
        for level in currents_A
    ]


def left_out(segments, most: int = 3) -> list[tuple[str, str]]:
    return [(one.kind, one.left_out) for one in folds_of(segments, most)]


# Folds


def test_currents_and_motions_are_left_out_whole() -> None:
    segments = rig_tests((0.0, 0.25, 0.5, 1.0), ((1.0, 8e-3), (3.0, 4e-3)))
    assert left_out(segments) == [
        (CURRENT, "0.25 A"),
        (CURRENT, "0.5 A"),
        (MOTION, "4 mm at 3 Hz"),
        (MOTION, "8 mm at 1 Hz"),
    ]
    for one in folds_of(segments):
        fit, validation = records_in(one.fit), records_in(one.validation)
        assert len(fit) + len(validation) == 8 and validation
        assert not {id(r) for r in fit} & {id(r) for r in validation}


def test_amplitudes_at_one_frequency_are_amplitudes() -> None:
    segments = rig_tests((0.0, 1.0), ((1.0, 2e-3), (1.0, 5e-3), (1.05, 9e-3)))
    assert {kind for kind, _ in left_out(segments)} == {AMPLITUDE}


def test_an_amplitude_of_several_motions_is_left_out_with_all_of_them() -> None:
    segments = rig_tests((0.0, 1.0), ((0.5, 9e-3), (1.0, 9e-3), (2.0, 3e-3)))
    found = [one for one in folds_of(segments) if one.kind == AMPLITUDE]
    assert [(one.left_out, len(one.validation)) for one in found] == [("9 mm", 4)]


def test_a_fold_never_asks_for_a_level_that_it_does_not_have() -> None:
    slow = rig_tests((0.0, 0.5, 1.0), ((1.0, 8e-3),))
    fast = rig_tests((0.0, 1.0), ((3.0, 3e-3),))
    assert left_out([*slow, *fast]) == [(CURRENT, "0.5 A"), (MOTION, "3 mm at 3 Hz")]


def test_where_nothing_whole_can_be_left_out_quarters_are() -> None:
    record = random_motion(3)
    last, second = folds_of([Segment(record, 100, 500)])
    assert (last.kind, last.left_out) == (QUARTERS, "the last quarter")
    assert [(s.first, s.end) for s in last.fit] == [(100, 400)]
    assert [(s.first, s.end) for s in last.validation] == [(400, 500)]
    assert [(s.first, s.end) for s in second.fit] == [(100, 200), (300, 500)]
    assert [(s.first, s.end) for s in second.validation] == [(200, 300)]


def test_switched_commands_and_short_tests_have_quarters_only() -> None:
    switched = random_motion(3, seconds=1.0, current_A=np.repeat([0.0, 1.0, 0.0], 167))
    assert {kind for kind, _ in left_out([whole(switched)])} == {QUARTERS}
    assert len(folds_of([Segment(switched, 0, 20)])) == 1


def test_two_levels_of_three_are_harder_and_do_not_stand_alone() -> None:
    found = folds_of(rig_tests((0.0, 0.5, 1.0), ((1.0, 8e-3),)))
    assert [(one.kind, one.is_harder) for one in found] == [
        (CURRENT, True), (QUARTERS, False), (QUARTERS, False),
    ]  # fmt: skip


def test_many_folds_are_spread_evenly() -> None:
    segments = rig_tests(np.linspace(0.0, 2.0, 9), ((1.0, 5e-3),))
    assert [text for _, text in left_out(segments)] == ["0.25 A", "1 A", "1.75 A"]
    assert [text for _, text in left_out(segments, most=2)] == ["0.25 A", "1.75 A"]


# Errors


def scored(errors: dict[str, list[float]], seed: int = 0, noise: float = 0.05) -> list[FoldScore]:
    """Folds with these errors on a force of unit size, each of 12 blocks that differ a little."""
    rng = np.random.default_rng(seed)
    found = []
    for kind, values in errors.items():
        for k, error in enumerate(values):
            squares = error**2 * (1.0 + noise * rng.standard_normal(12))
            test = Blocks(tuple(map(float, squares)), (1.0,) * 12)
            found.append(FoldScore(kind, str(k), (test,)))
    return found


def test_error_of_a_fold_is_that_of_its_rows() -> None:
    record = random_motion(4)
    fold = folds_of([whole(record)])[0]
    forces = forces_on(lambda one: 0.9 * one.force_N, fold.validation)
    assert fold_score(fold, forces).error == pytest.approx(0.1)
    split = blocks_of(record.force_N, 1.2 * record.force_N)
    assert split.error == pytest.approx(0.2) and len(split.error_N2) == 12
    assert np.isinf(blocks_of(record.force_N, np.full(len(record), np.nan)).error)


def test_one_number_is_the_geometric_mean_over_kinds() -> None:
    by_kind = errors_by_kind(scored({CURRENT: [0.1, 0.3], MOTION: [0.05]}, noise=0.0))
    assert by_kind == {CURRENT: pytest.approx(0.2), MOTION: pytest.approx(0.05)}
    assert overall(by_kind) == pytest.approx(0.1)


def test_share_tells_a_clear_lead_from_a_close_one() -> None:
    good, close, bad = (
        scored({CURRENT: [size, size], MOTION: [size]}, seed=k, noise=0.5)
        for k, size in enumerate((0.10, 0.101, 0.2))
    )
    assert share_before(good, bad) > 0.99 and share_before(bad, good) < 0.01
    assert 0.2 < share_before(good, close) < 0.8
    assert share_before(good, good) == pytest.approx(0.5)
    assert share_before(good, good[:1]) is None and share_before([], []) is None


def test_draws_pair_blocks_so_that_a_common_hard_stretch_cancels() -> None:
    """Of two models that differ by 2 % in every block the better one always comes first."""
    hard = scored({QUARTERS: [0.1]}, noise=0.9)
    test = hard[0].tests[0]
    worse = [
        replace(hard[0], tests=(replace(test, error_N2=tuple(1.04 * e for e in test.error_N2)),))
    ]
    assert share_before(hard, worse) == 1.0


# Bands


def unseen(level_N: float, size_N: float, seed: int, rows: int = 4000) -> LeftOut:
    rng = np.random.default_rng(seed)
    return LeftOut(size_N * rng.standard_normal(rows), np.full(rows, level_N))


def test_band_holds_95_percent_of_noise_at_every_level() -> None:
    """Deviations of a tenth of the level: power 1, half width 1.96 deviations."""
    tests = [unseen(level_N, 0.1 * level_N, k) for k, level_N in enumerate((50.0, 200.0, 1000.0))]
    band = band_of(tests)
    assert band.power == pytest.approx(1.0, abs=0.05)
    for one in tests:
        inside = np.abs(one.residual_N) <= band.half_width_N(one.level_N)
        assert np.mean(inside) == pytest.approx(0.95, abs=0.015)


def test_band_of_one_size_everywhere_is_flat() -> None:
    band = band_of([unseen(50.0, 10.0, 1), unseen(1000.0, 10.0, 2)])
    assert band.power == pytest.approx(0.0, abs=0.05)
    assert band.half_width_N(np.array([50.0, 1000.0])) == pytest.approx([19.6, 19.6], rel=0.1)


def test_band_at_one_level_is_in_proportion_beyond_it() -> None:
    band = band_of([unseen(100.0, 10.0, 1)])
    assert band.half_width_N(np.array([200.0])) == pytest.approx([39.2], rel=0.05)


def test_every_test_counts_the_same_in_a_band() -> None:
    many, few = unseen(100.0, 1.0, 1, rows=100_000), unseen(100.0, 10.0, 2, rows=100)
    band = band_of([many, few])
    # Half of the weight has ten times the deviation: 90 % of it have to lie inside.
    assert band.half_width_N(np.array([100.0]))[0] == pytest.approx(16.4, rel=0.25)


def test_model_that_diverges_has_no_finite_band_and_no_rows_no_band() -> None:
    broken = LeftOut(np.array([1.0, np.nan]), np.array([1.0, np.nan]))
    assert np.isinf(band_of([broken]).part)
    assert band_of([]) is None


def test_band_knows_its_folds_and_leaves_harder_ones_out() -> None:
    folds = folds_of(rig_tests((0.0, 0.5, 1.0), ((1.0, 8e-3), (3.0, 4e-3))))
    assert {one.kind for one in folds if one.is_harder} == {CURRENT}
    found = validated([lambda record: 0.9 * record.force_N] * len(folds), folds)
    assert found.band.kinds == (MOTION,)
    assert {one.kind for one in found.folds} == {CURRENT, MOTION}


def test_level_is_the_peak_of_the_cycle() -> None:
    record = sine(1.0, 5e-3, 0.5)
    force_N = 100.0 * np.sin(2.0 * np.pi * record.time_s)
    assert levels_along(whole(record), force_N) == pytest.approx(100.0, rel=1e-3)


def test_coverage_is_the_part_inside() -> None:
    record: Record = sine(1.0, 5e-3, 0.5)
    shifted = replace(record, force_N=record.force_N + np.where(record.time_s < 1.0, 50.0, 0.0))
    size = float(np.abs(record.force_N).max())
    band = Band(40.0 / size, 1.0, size)
    found = coverage(band, [whole(shifted)], [record.force_N])
    assert found == pytest.approx(0.75, abs=0.01)
