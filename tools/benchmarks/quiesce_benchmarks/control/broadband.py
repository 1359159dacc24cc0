"""Inputs that no table was made for: against the best constant current of each of them."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import measurements, shown

from quiesce_benchmarks.control.measures import band_bound_pct, band_reduction_pct, chirp_peaks
from quiesce_benchmarks.control.rig import OPEN_LOOP, SETTINGS, Rig, constant, grid_A
from quiesce_benchmarks.control.ruler import Ruler
from quiesce_benchmarks.control.scenarios import (
    Chirp,
    Scenario,
    earthquake,
    impulse,
    random_force,
    scaled,
    two_tones,
)

EARTHQUAKES = {"El Centro": "el_centro_1940_ns.csv", "Kobe": "kobe_1995.csv"}
PEAKS_um = (100.0, 300.0)
TIME_SCALES = (1.0, 5.0)
AFTER_s = 2.0  # of free decay, after an earthquake
PAIRS_Hz = ((5.0, 8.0), (6.0, 14.0), (9.0, 16.0))
BANDS_Hz = ((3.0, 7.0), (7.0, 15.0), (4.0, 22.0))
STATIONARY_s = 60.0
CHIRP = Chirp(4.0, 22.0, 0.5)
LOW_BAND_Hz = (4.0, 10.0)
IMPULSE_PULSE_s = 0.005
IMPULSE_PEAK_um = 100.0
IMPULSE_s = 6.0
GRID_STEP_A = 0.25
CHIRP_COLUMNS = ("t_s", "x5_um")


@dataclass(frozen=True)
class Response:
    rms_disp_um: float
    accel_rms_mm_s2: float
    mean_current_A: float


@dataclass(frozen=True)
class Input:
    """One excitation, from rest to its end. `law`: by setting."""

    name: str
    open_loop: Response
    constant_disp_A: float  # best constant current for displacement, and what it does
    constant_disp: Response
    constant_accel_A: float  # and for acceleration
    constant_accel: Response
    law: dict[str, Response]

    def disp_ratio(self, setting: str) -> float:
        return self.law[setting].rms_disp_um / self.constant_disp.rms_disp_um

    def accel_ratio(self, setting: str) -> float:
        return self.law[setting].accel_rms_mm_s2 / self.constant_accel.accel_rms_mm_s2

    def accel_ratio_of_disp(self, setting: str) -> float:
        """Against the one constant that is best for displacement."""
        return self.law[setting].accel_rms_mm_s2 / self.constant_disp.accel_rms_mm_s2

    def row(self) -> dict[str, Any]:
        ratios = {
            name: {
                "disp_ratio": self.disp_ratio(name),
                "accel_ratio": self.accel_ratio(name),
                "accel_ratio_of_disp_constant": self.accel_ratio_of_disp(name),
            }
            for name in SETTINGS
        }
        return {**asdict(self), "ratios": ratios}


def response(figures: dict[str, Any]) -> Response:
    return Response(figures["rms_disp_um"], figures["accel_rms_mm_s2"], figures["mean_current_A"])


def measure_input(rig: Rig, scenario: Scenario, step_A: float) -> Input:
    constants = {
        current_A: response(rig.run(scenario, constant(current_A)).figures)
        for current_A in grid_A(rig.full_A, step_A)
    }
    disp_A = min(constants, key=lambda current_A: constants[current_A].rms_disp_um)
    accel_A = min(constants, key=lambda current_A: constants[current_A].accel_rms_mm_s2)
    return Input(
        name=scenario.name,
        open_loop=response(rig.run(scenario, OPEN_LOOP).figures),
        constant_disp_A=disp_A,
        constant_disp=constants[disp_A],
        constant_accel_A=accel_A,
        constant_accel=constants[accel_A],
        law={
            name: response(rig.run(scenario, rig.judged.control(name)).figures) for name in SETTINGS
        },
    )


def sized(rig: Rig, scenario: Scenario, key: str, peak_um: float) -> Scenario:
    """Scaled to that peak displacement at 0 A, within 0.1 %; the response is nearly linear."""
    for _ in range(8):
        found_um = rig.run(scenario, OPEN_LOOP).figures["peak_disp_um"]
        if abs(found_um / peak_um - 1.0) < 1e-3:
            break
        scenario = scaled(scenario, key, peak_um / found_um)
    return scenario


def made_inputs(rig: Rig, seed: int) -> list[Scenario]:
    """Without recordings. The chirp is first."""
    drive_V = rig.plant.drive_V
    blow = impulse(1e-3, IMPULSE_PULSE_s, IMPULSE_s)
    return [
        CHIRP.scenario(),
        *(two_tones(pair, drive_V, STATIONARY_s) for pair in PAIRS_Hz),
        *(
            random_force(*band, drive_V / np.sqrt(2.0).item(), seed, STATIONARY_s)
            for band in BANDS_Hz
        ),
        sized(rig, blow, "impulse_N_s", IMPULSE_PEAK_um),
    ]


def default_folder() -> Path:
    """Beside the project; the recordings do not ship with it."""
    return measurements("earthquake")


def find_folder(given: Path | None) -> Path:
    """UsageError where a folder is named and is not there."""
    if given is not None and not given.is_dir():
        names = " and ".join(EARTHQUAKES.values())
        raise UsageError(f"--data {given}: no such folder; name the one with {names}")
    return given or default_folder()


def record_length_s(file: Path) -> float:
    """From the times in its first and last row."""
    rows = file.read_text(encoding="utf-8").split()
    return float(rows[-1].split(",")[0]) - float(rows[1].split(",")[0])


def earthquakes(rig: Rig, folder: Path) -> list[Scenario]:
    """Each at both sizes and time scales. UsageError where the plant has no moving base."""
    out = []
    for name, file_name in EARTHQUAKES.items():
        file = folder / file_name
        length_s = record_length_s(file)
        for time_scale in TIME_SCALES:
            duration_s = round(length_s / time_scale + AFTER_s, 3)
            record = earthquake(name, file, 1e-3, time_scale, duration_s)
            for peak_um in PEAKS_um:
                label = f"{name} x{time_scale:g}, {peak_um:g} um"
                out.append(replace(sized(rig, record, "gain", peak_um), name=label))
    return out


def absent_earthquakes(rig: Rig, folder: Path) -> list[str]:
    """Why there are none, a line each; empty where there are."""
    files = [folder / name for name in EARTHQUAKES.values()]
    lines = [f"{shown(file)}: not on this machine" for file in files if not file.is_file()]
    if not lines:
        try:
            rig.run(earthquake("probe", files[0], 1e-3, 1.0, 0.1), OPEN_LOOP)
        except UsageError as error:
            lines.append(f"earthquakes: {one_line(error)}")
    return lines


@dataclass(frozen=True)
class ChirpResult:
    """The chirp's cycles: middle frequency (n,) and half peak-to-peak by control, um (n,)."""

    freq_Hz: np.ndarray
    peaks_um: dict[str, np.ndarray]

    @property
    def open_loop_um(self) -> np.ndarray:
        return self.peaks_um["open loop"]

    def low_reduction_pct(self, control: str) -> float:
        """Over LOW_BAND_Hz."""
        return band_reduction_pct(
            self.freq_Hz, self.peaks_um[control], self.open_loop_um, LOW_BAND_Hz
        )

    def low_bound_pct(self, ruler: Ruler) -> float | None:
        """None: the bound is not known over the band."""
        grid = ruler.amp_grid(LOW_BAND_Hz)
        if grid is None:
            return None
        return band_bound_pct(self.freq_Hz, self.open_loop_um, LOW_BAND_Hz, *grid)

    def row(self, ruler: Ruler) -> dict[str, Any]:
        return {
            "low_reduction_pct": {name: self.low_reduction_pct(name) for name in self.peaks_um},
            "low_bound_pct": self.low_bound_pct(ruler),
        }


def low_fraction(chirp: ChirpResult, setting: str, ruler: Ruler) -> float | None:
    bound_pct = chirp.low_bound_pct(ruler)
    return None if bound_pct is None else chirp.low_reduction_pct(setting) / bound_pct


def measure_chirp(rig: Rig) -> ChirpResult:
    controls = {"open loop": OPEN_LOOP, "constant": constant(rig.full_A)}
    controls |= {name: rig.judged.control(name) for name in SETTINGS}
    peaks = {}
    for name, control in controls.items():
        trace = rig.run(CHIRP.scenario(), control, columns=CHIRP_COLUMNS).trace
        assert trace is not None
        freq_Hz, peaks[name] = chirp_peaks(
            trace["t_s"], trace["x5_um"], CHIRP.from_Hz, CHIRP.slope_Hz_s
        )
    return ChirpResult(freq_Hz, peaks)


def worst_ratio(inputs: Sequence[Input], setting: str, kind: str) -> float:
    """kind: disp or accel."""
    ratio = Input.disp_ratio if kind == "disp" else Input.accel_ratio
    return max(ratio(one, setting) for one in inputs)


def mean_current_A(inputs: Sequence[Input], setting: str) -> float:
    """Each input counts once, however long it is."""
    return float(np.mean([one.law[setting].mean_current_A for one in inputs]))
