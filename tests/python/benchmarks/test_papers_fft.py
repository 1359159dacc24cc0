"""The part `fft` of the benchmark `papers`: both estimators on the same records and ticks."""

from pathlib import Path

import numpy as np
import pytest
from conftest import require
from quiesce.engine.bench import Bench
from quiesce_benchmarks.papers.parts import fft
from quiesce_benchmarks.part import Effort
from quiesce_benchmarks.signal import accuracy, estimators
from quiesce_benchmarks.signal.cost import measure_ticks

TICKS = 4000


@pytest.fixture(autouse=True)
def own_build(build: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))


def test_same_records_go_through_both_and_both_find_the_tone() -> None:
    groups = {
        name: accuracy.measure_accuracy(rig, 5, 6, 30, "10 Hz")
        for name, rig in estimators.rigs([]).items()
    }
    fit, other = (groups[name].readings for name in estimators.ESTIMATORS)
    assert np.array_equal(fit.freq_Hz, other.freq_Hz)
    assert np.array_equal(other.window_ms, np.full(6, 1024.0))
    assert not np.array_equal(fit.error_Hz, other.error_Hz)
    assert np.max(np.abs(other.error_Hz)) < 0.05
    assert fit.ratio < 2.5
    assert other.ratio < 6.0
    rows = {"accuracy": estimators.accuracy_rows({name: [g] for name, g in groups.items()})}
    assert [row["estimator"] for row in rows["accuracy"]] == ["fit", "fft"]
    (shown,) = estimators.tables(rows)
    assert "fft" in shown and "30" in shown


@pytest.mark.parametrize("rate_Hz", [500, 4000])
def test_fft_has_no_tick_spike(build: Path, rate_Hz: int) -> None:
    image = require(build / "mps2/tools/benchmarks/signal_cost.elf")
    cost = measure_ticks(Bench(), image, rate_Hz, TICKS * rate_Hz // 1000, 1)
    # A spike is what a whole transform in one tick would be: more than 100,000 instructions.
    assert cost.worst_instr < 6000
    assert cost.worst_instr <= 2 * cost.median_instr


@pytest.mark.slow
def test_the_part_measures_its_figures(tmp_path: Path) -> None:
    found = fft.measure(Effort(1, True, tmp_path)).values
    assert set(found) == {name for name, *_ in fft.FIGURES}
    assert found["fft_freq_rmse_over_crlb"] > found["fit_freq_rmse_over_crlb"] > 1.0
    assert 1.0 < found["fft_worst_tick_over_median"] <= 2.0
