"""Spectra of the live page: against scipy's Welch, what is asked for, and beside a controller."""

import json
import math
from collections.abc import Iterator

import numpy as np
import pytest
from can_bus import Controller, build_peer
from live_page import Page, Viewer
from quiesce.can.database import load
from quiesce.live.protocol import Command, Malformed, command_of
from quiesce.live.rings import Ring
from quiesce.live.series import catalogue
from quiesce.live.spectrum import NONE, Spectra, SpectrumPlan, mean_power
from quiesce.live.viewer import SPECTRUM_BEATS
from quiesce_benchmarks.live.rig import PATIENCE_S
from scipy.signal import welch

SERIES = catalogue(load())
RAW = next(one for one in SERIES if (one.message, one.signal) == ("RawSample", "accel_counts"))
RATE_Hz = 1000.0
SPECTRUM = {"do": "spectrum", "series": 1, "length_s": 2, "averages": 4, "most_Hz": 50}


def times_of(count: int) -> np.ndarray:
    return 1.8e9 + np.arange(count) / RATE_Hz


@pytest.mark.parametrize("length", [256, 255, 1000])
@pytest.mark.parametrize("windows", [1, 2, 5])
def test_power_is_that_of_scipy(length: int, windows: int) -> None:
    count = length + (windows - 1) * (length // 2)
    values = 7.0 + np.random.default_rng(3).normal(size=count)
    power, used = mean_power(times_of(count), values, length)
    _, wanted = welch(
        values,
        nperseg=length,
        noverlap=length - length // 2,
        window="hann",
        detrend="constant",
        scaling="spectrum",
    )
    assert used == windows
    inner = slice(1, -1)  # the lines at both ends have no twin, and are none that vibrate
    assert np.allclose(power[inner], wanted[inner], rtol=1e-9)


def test_a_sine_stands_as_high_as_its_rms() -> None:
    times_s = times_of(4000)
    values = 300.0 * np.sqrt(2.0) * np.sin(2.0 * np.pi * 12.0 * times_s) - 5000.0
    power, used = mean_power(times_s, values, 2000)
    assert used == 3 and int(np.argmax(power)) == 24
    assert math.isclose(math.sqrt(power[24]), 300.0, rel_tol=1e-3)


def test_windows_with_a_gap_are_left_out() -> None:
    times_s = times_of(3000)
    times_s[1200:] += 0.3
    _, used = mean_power(times_s, np.ones(3000), 500)
    assert used == 11 - 2
    assert mean_power(times_s[:400], np.ones(400), 500)[1] == 0
    assert mean_power(times_s[:0], np.ones(0), 0)[1] == 0


def ring_of(frequency_Hz: float, count: int) -> Ring:
    ring = Ring(4096)
    for i, time_s in enumerate(times_of(count)):
        value = round(1000.0 * math.sin(2.0 * math.pi * frequency_Hz * i / RATE_Hz))
        ring.add(time_s, (value % 2**RAW.bits << RAW.start_bit).to_bytes(8, "little"))
    return ring


def test_spectra_are_computed_once_for_all_who_want_the_same() -> None:
    ring = ring_of(20.0 / 1.024, 3500)  # the line 20 of 1024 samples
    spectra = Spectra(SERIES, {RAW.frame_id: ring})
    plan = SpectrumPlan(RAW.number, 1.0, 4, 50.0)
    told = json.loads(json.dumps(spectra.of(plan), allow_nan=False))
    assert told["used"] == 4 and math.isclose(told["rate_Hz"], RATE_Hz, rel_tol=1e-4)
    assert len(told["rms"]) == 52 and int(np.argmax(told["rms"])) == 20
    assert math.isclose(told["rms"][20], 1000.0 / math.sqrt(2.0), rel_tol=1e-3)
    assert spectra.of(plan)["rms"] is spectra.of(plan)["rms"]
    ring.add(1.8e9 + 3.5, b"")
    assert spectra.of(plan)["rms"] is not spectra.of(SpectrumPlan(RAW.number, 1.0, 4, 40.0))["rms"]


@pytest.mark.parametrize("count", [0, 1, 2, 900])
def test_too_few_samples_have_no_spectrum(count: int) -> None:
    told = Spectra(SERIES, {RAW.frame_id: ring_of(20.0, count)}).of(
        SpectrumPlan(RAW.number, 1.0, 1, 50.0)
    )
    assert (told["used"], told["rms"]) == (NONE.used, NONE.rms)


def test_samples_that_come_all_at_once_have_no_spectrum() -> None:
    ring = Ring(4096)
    for _ in range(2000):
        ring.add(1.8e9, b"\x01")
    told = Spectra(SERIES, {RAW.frame_id: ring}).of(SpectrumPlan(RAW.number, 1.0, 1, 50.0))
    assert told["used"] == 0


def test_spectra_that_are_wanted_are_what_the_reference_says() -> None:
    assert command_of(json.dumps(SPECTRUM), 9) == Command(
        "spectrum", spectrum=SpectrumPlan(1, 2.0, 4, 50.0)
    )
    assert command_of(json.dumps({**SPECTRUM, "series": None}), 9) == Command("spectrum")


@pytest.mark.parametrize(
    "wrong",
    [
        {"series": 9}, {"series": -1}, {"series": True}, {"series": "1"}, {"length_s": 0},
        {"length_s": 17}, {"length_s": "2"}, {"length_s": None}, {"averages": 0}, {"averages": 17},
        {"averages": 1.5}, {"averages": True}, {"most_Hz": 0}, {"most_Hz": 501},
        {"length_s": 16, "most_Hz": 500}, {"more": 1}, {"series": [1]}, {"most_Hz": 10**400},
    ],
)  # fmt: skip
def test_other_spectra_are_malformed(wrong: dict) -> None:
    with pytest.raises(Malformed):
        command_of(json.dumps({**SPECTRUM, **wrong}), 9)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    folder = tmp_path_factory.mktemp("live_spectrum")
    controller = Controller(build_peer(folder), folder)
    controller.start()
    one = Page(folder, "--bus", controller.bus, "--raw")
    yield one
    assert one.end() == 0
    controller.stop()


def texts_of(viewer: Viewer, packets: int) -> list[dict]:
    """All of them that come until so many packets have."""
    texts = []
    while packets:
        message = viewer.socket.recv(PATIENCE_S)
        if isinstance(message, bytes):
            packets -= 1
        else:
            texts.append(json.loads(message))
    return texts


def test_spectrum_of_a_controllers_samples_has_the_frequency_that_it_reports(page: Page) -> None:
    with page.viewer() as viewer:
        series = viewer.series("RawSample", "accel_counts")
        viewer.ask("spectrum", series=series, length_s=1, averages=1, most_Hz=50)
        told = viewer.until("spectrum", lambda one: one["used"] and one["freq_Hz"] is not None)
        strongest_Hz = int(np.argmax(told["rms"])) * told["step_Hz"]
        assert abs(strongest_Hz - told["freq_Hz"]) <= 2.0 * told["step_Hz"]
        viewer.ask("spectrum", series=None, length_s=1, averages=1, most_Hz=50)
        viewer.socket.send("what follows was sent after that was heard")
        viewer.note()
        assert not any("spectrum" in one for one in texts_of(viewer, 3 * SPECTRUM_BEATS))
