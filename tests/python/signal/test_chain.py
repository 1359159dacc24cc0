"""The stated magnitude and phase of the conditioning are those of the firmware."""

import ctypes
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.engine.bench import Bench
from quiesce.signal.chain_response import (
    TICK_RATES_Hz,
    alias_rejection_dB,
    dc_removal,
    decibels,
    decimation,
    degrees,
    fitted,
    measure_dc_removal,
)


@pytest.fixture
def bench(build: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    return Bench()


def difference(bench: Bench, freq_Hz: float, cutoff_mHz: int, rate_Hz: int) -> tuple[float, float]:
    """Measured against computed: dB, degree."""
    measured = measure_dc_removal(bench, freq_Hz, cutoff_mHz, rate_Hz)
    ratio = np.array(measured / dc_removal(np.array(freq_Hz), cutoff_mHz, rate_Hz))
    return float(decibels(np.abs(ratio))), float(degrees(ratio))


@pytest.mark.parametrize("rate_Hz", TICK_RATES_Hz)
@pytest.mark.parametrize("cutoff_mHz", [50, 200, 1000])
def test_dc_removal_is_as_computed(bench: Bench, cutoff_mHz: int, rate_Hz: int) -> None:
    for freq_Hz in (0.1, 0.7, 4.0, 45.0, 125.0):
        gain_dB, phase_deg = difference(bench, freq_Hz, cutoff_mHz, rate_Hz)
        assert abs(gain_dB) < 0.001 and abs(phase_deg) < 0.01, f"at {freq_Hz} Hz"


def test_a_corner_that_is_off_by_a_percent_would_be_seen(bench: Bench) -> None:
    measured = measure_dc_removal(bench, 0.2, 202, 1000)
    ratio = measured / complex(dc_removal(np.array(0.2), 200, 1000))
    assert abs(float(decibels(abs(ratio)))) > 0.03


@pytest.fixture(scope="module")
def decimator(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The firmware's decimate.c as a library."""
    library = tmp_path_factory.mktemp("decimate") / "decimate.so"
    source = ROOT / "firmware/sense/decimate.c"
    options = ["-std=c11", "-O2", "-shared", "-fPIC", "-I", str(ROOT / "firmware/base")]
    subprocess.run(["gcc", *options, str(source), "-o", str(library)], check=True)
    loaded = ctypes.CDLL(str(library))
    loaded.decimate_step.restype = ctypes.c_bool
    return loaded


def decimated(decimator: ctypes.CDLL, samples: np.ndarray, rate_Hz: int) -> tuple:
    """Ticks at which an output came, and the outputs."""
    state = (ctypes.c_uint64 * 128)()  # larger than decimate_t
    decimator.decimate_init(state, ctypes.c_uint32(rate_Hz), ctypes.c_uint32(250))
    ticks, outputs = [], []
    value = ctypes.c_int32()
    for tick, sample in enumerate(samples):
        value.value = int(sample)
        if decimator.decimate_step(state, ctypes.byref(value)):
            ticks.append(tick)
            outputs.append(value.value)
    return np.array(ticks), np.array(outputs, dtype=float)


@pytest.mark.parametrize("rate_Hz", TICK_RATES_Hz)
def test_decimation_is_as_computed(decimator: ctypes.CDLL, rate_Hz: int) -> None:
    amplitude_um_s2 = 2e8
    for freq_Hz in (0.5, 5.0, 31.0, 50.0, 90.0, 113.0, 180.0, 230.0):
        turns = np.arange(2 * rate_Hz) * freq_Hz / rate_Hz
        samples = np.rint(amplitude_um_s2 * np.cos(2 * np.pi * turns))
        ticks, outputs = decimated(decimator, samples, rate_Hz)
        settled = ticks >= rate_Hz  # whole cycles of every frequency are left
        assert np.diff(ticks) == pytest.approx(rate_Hz / 250)
        measured = fitted(outputs[settled], turns[ticks[settled]]) / amplitude_um_s2
        gain, delay_s = decimation(np.array(freq_Hz), rate_Hz)
        computed = gain * np.exp(-2j * np.pi * freq_Hz * delay_s)
        assert abs(measured - computed) < 1e-6, f"at {freq_Hz} Hz"


@pytest.mark.parametrize("rate_Hz", TICK_RATES_Hz)
def test_what_folds_into_the_band_is_gone(rate_Hz: int) -> None:
    assert alias_rejection_dB(rate_Hz, 50.0) > 60.0


@pytest.mark.slow
def test_documented_table_is_what_the_command_writes(quiesce, tmp_path: Path) -> None:
    result = quiesce("chain", "--out", "out")
    assert result.returncode == 0, result.stderr
    table = (tmp_path / "out/conditioning.md").read_text()
    assert table in result.stdout
    assert table in (ROOT / "docs/explanation/signal-chain.md").read_text()
    assert (tmp_path / "out/conditioning.svg").read_text().count("<path") > 20


@pytest.mark.slow
def test_chain_follows_the_corner(quiesce, tmp_path: Path) -> None:
    assert quiesce("chain", "--out", "out", "--set", "dc_cutoff_mHz=1000").returncode == 0
    row = next(
        r
        for r in (tmp_path / "out/conditioning.md").read_text().splitlines()
        if r.startswith("| 1 |")
    )
    gain_dB, phase_deg = map(float, row.split("|")[2].split("/"))
    assert gain_dB == pytest.approx(-3.0, abs=0.05)
    assert phase_deg == pytest.approx(45.0, abs=0.3)


def test_chain_refuses_a_corner_out_of_range(refused) -> None:
    assert "dc_cutoff_mHz" in refused("chain", "--set", "dc_cutoff_mHz=5", "--out", "out")
