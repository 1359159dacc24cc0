"""Recordings give the same telemetry bit for bit: host, 32-bit program, image.

Random input is compared by the C test same_bits in every build.
"""

import csv
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, require
from quiesce.engine.bench import Bench, target_options
from quiesce.engine.params import effective_params
from quiesce.signal.recording import read_recording
from quiesce.signal.replay import own_sensor
from quiesce.signal.resample import resample

SHIPPED = ROOT / "sim_hil/data/recordings/step_10_20Hz.csv"
MEASURED = ROOT.parent / "shared/data/vibration"


def recordings() -> Iterator[tuple[Path, str, str]]:
    """File, column, unit: the shipped one, and every measured channel that is at hand."""
    yield SHIPPED, "accel_m_s2", "m_s2"
    for file in sorted(MEASURED.glob("*.csv")):
        with file.open(newline="") as stream:
            for column in next(csv.reader(stream))[1:]:
                yield file, column, "g"


@pytest.fixture
def bench(build: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    monkeypatch.setenv("QUIESCE_BUILD", str(build))
    return Bench()


def bench_crc32(bench: Bench, counts_file: Path, target: str) -> int:
    trace = counts_file.with_suffix(f".{target}")
    files = ["--counts", str(counts_file), "--trace", str(trace)]
    return bench.json("replay", *files, *target_options(target))["telemetry_crc32"]


def program_crc32(program: Path, counts_file: Path) -> int:
    call = [str(require(program)), str(counts_file)]
    return int(subprocess.run(call, capture_output=True, text=True, check=True).stdout, 16)


EVERY_RECORDING = pytest.mark.parametrize(
    ("file", "column", "unit"), [*recordings()], ids=lambda value: getattr(value, "stem", value)
)


@pytest.fixture
def counts(bench: Bench, file: Path, column: str, unit: str) -> np.ndarray:
    """What the sensor gives of a recording."""
    params = effective_params(bench, [])
    recording = read_recording(file, [column], "t_s")
    accel_m_s2 = recording.accel_m_s2(column, unit)
    sampled = resample(accel_m_s2, recording.rate_Hz, params["tick_rate_Hz"])
    return own_sensor(params).counts(sampled)


@pytest.mark.slow
@EVERY_RECORDING
def test_recording_gives_the_same_bits_everywhere(
    bench: Bench, build: Path, image: Path, tmp_path: Path, counts: np.ndarray
) -> None:
    counts_file = tmp_path / "counts"
    counts.tofile(counts_file)
    host = bench_crc32(bench, counts_file, "host")
    assert bench_crc32(bench, counts_file, "mps2") == host
    assert program_crc32(build / "host/tests/unit/firmware/same_bits", counts_file) == host
    # One count of one sample is seen.
    counts[len(counts) // 2] += np.int32(1)
    counts.tofile(counts_file)
    assert bench_crc32(bench, counts_file, "host") != host


@pytest.mark.slow  # the 32-bit build
@EVERY_RECORDING
def test_recording_gives_the_same_bits_to_a_32_bit_program(
    bench: Bench, build: Path, tmp_path: Path, counts: np.ndarray
) -> None:
    counts_file = tmp_path / "counts"
    counts.tofile(counts_file)
    program = build / "m32/tests/unit/firmware/same_bits"
    assert program_crc32(program, counts_file) == bench_crc32(bench, counts_file, "host")


@pytest.mark.slow
def test_the_32_bit_program_is_one(build: Path) -> None:
    with require(build / "m32/tests/unit/firmware/same_bits").open("rb") as program:
        header = program.read(5)
    assert header == b"\x7fELF\x01"  # class 1: 32 bit
