"""What `./tools/benchmark unseen` plants is there, and nothing else."""

import numpy as np
import pytest
from quiesce.damper.data.read import RawTest
from quiesce_benchmarks.unseen.parts.rigs import NOISE_N, recorded
from quiesce_benchmarks.unseen.planted import CLIPPED_AT, STUCK_S, clipped, exported, stuck


def test_mass_of_the_rig_adds_its_inertia() -> None:
    bare, heavy = (recorded("bingham", mass_kg, 0.0, 1).record for mass_kg in (0.0, 2.5))
    rest_N = heavy.force_N - bare.force_N - 2.5 * bare.accel_m_s2
    assert float(np.std(rest_N)) == pytest.approx(np.sqrt(2.0) * NOISE_N, rel=0.1)


def sine_test() -> RawTest:
    time_s = np.arange(4000) / 1000.0
    angle = 2.0 * np.pi * time_s
    si = {"displacement": np.sin(angle), "force": 100.0 * np.cos(angle)}
    return RawTest("made", "made.csv:2", 1e-3, 0.0, time_s, si, 0.0)


def test_faults_are_planted_as_described() -> None:
    test = sine_test()
    assert float(np.ptp(clipped(test).si["force"])) == pytest.approx(200.0 * CLIPPED_AT)
    held = stuck(test, "displacement", 100.0).si["displacement"]
    rows = round(STUCK_S / test.period_s)
    assert np.ptp(held[-rows:]) == 0.0 and np.array_equal(
        held[:-rows], test.si["displacement"][:-rows]
    )


def test_exported_file_is_thinned_in_step() -> None:
    out = exported(sine_test(), 1000.0, 0.0, 1)
    assert out.period_s == pytest.approx(0.025) and len(out.si["force"]) == len(out.time_s) == 160
    assert np.allclose(out.si["force"], 100.0 * np.cos(2.0 * np.pi * out.time_s), atol=1.0)
