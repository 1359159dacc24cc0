"""Sensors of the squeeze-mode paper (II.A, Table II, IV.A): what their dynamics cost a loop."""

import math
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.engine.bench import Bench
from quiesce.engine.pool import run_all

from quiesce_benchmarks.part import Effort, Measured

TITLE = "sensors: band, corner, noise and drift of the published parts"
FIGURES = (
    ("sensor_stated_5Hz_pct", "%", None, "higher"),
    ("sensor_unstated_5Hz_pct", "%", None, "higher"),
    ("sensor_ideal_5Hz_pct", "%", None, "higher"),
    ("sensor_stated_loss_5Hz_pt", "pt", 0.5, "lower"),
)

DATA = Path("sim_hil/data")
RIG = "squeeze_2012_nodes.toml"
LAW = "phase"
FREQS_Hz = (5.0, 10.0, 15.0, 20.0)
DURATION_s, WINDOW_s = 8.0, 2.0
SEEDS = 4
CASES = ("stated", "unstated", "ideal")


def read(path: Path) -> dict[str, Any]:
    return tomllib.loads((root() / path).read_text(encoding="utf-8"))


def board_of(case: str) -> dict[str, Any]:
    """The rig's board; only `stated` knows the accelerometer's corner."""
    board = read(DATA / "boards" / RIG)
    if case != "stated":
        for sensor in board["sensor"]:
            sensor.pop("corner_mHz", None)
    return board


def plant_of(case: str) -> dict[str, Any]:
    """The rig's plant, wherever it is written. `ideal`: its accelerometer has its noise only."""
    plant = read(DATA / "plants" / RIG)
    folder = (root() / DATA / "plants").resolve()
    for sensor in [plant["sensor"], *plant["sensors"].values()]:
        sensor["file"] = str((folder / sensor["file"]).resolve())
    if case == "ideal":
        noise = tomllib.loads(Path(plant["sensors"]["accel"]["file"]).read_text())["noise"]
        plant["noise"] = {"accel": noise}
        del plant["sensors"]["accel"]
    return plant


def write_scenario(folder: Path, case: str, freq_Hz: float) -> Path:
    name = f"{case}_{freq_Hz:g}Hz"
    plant, board = folder / f"{case}_plant.toml", folder / f"{case}_board.toml"
    plant.write_text(tomli_w.dumps(plant_of(case)), encoding="utf-8")
    board.write_text(tomli_w.dumps(board_of(case)), encoding="utf-8")
    scenario = {
        "schema": "quiesce-scenario",
        "version": 1,
        "name": name,
        "plant": plant.name,
        "board": board.name,
        "duration_s": DURATION_s,
        "segment": [{"kind": "sine", "freq_Hz": freq_Hz}],
        "window": [{"start_s": DURATION_s - WINDOW_s, "end_s": DURATION_s}],
    }
    file = folder / f"{name}.toml"
    file.write_text(tomli_w.dumps(scenario), encoding="utf-8")
    return file


def reductions_pct(bench: Bench, folder: Path, seeds: range, freqs: tuple[float, ...]) -> Any:
    """Displacement amplitude taken off by the law, %: [case][frequency][seed]."""
    files = {(c, f): write_scenario(folder, c, f) for c in CASES for f in freqs}

    def amp_um(file: Path, law: str, seed: int) -> float:
        options = ("--scenario", str(file), "--law", law, "--seed", str(seed))
        return bench.json("run", *options)["amp_um"]

    def off_pct(case: str, freq_Hz: float, seed: int) -> float:
        file = files[case, freq_Hz]
        return 100.0 * (1.0 - amp_um(file, LAW, seed) / amp_um(file, "off", seed))

    jobs = [(c, f, s) for c in CASES for f in freqs for s in seeds]
    found = run_all(bench, [lambda job=job: off_pct(*job) for job in jobs])
    return np.reshape(found, (len(CASES), len(freqs), len(seeds)))


def lead_deg(sensor: dict[str, Any], freq_Hz: float) -> float:
    """Of its first-order corner, less the lag of its band."""
    corner_Hz, band_Hz = sensor.get("corner_Hz", 0.0), sensor.get("band_Hz", math.inf)
    return math.degrees(math.atan(corner_Hz / freq_Hz) - math.atan(freq_Hz / band_Hz))


def parts_table() -> str:
    """The sensor files, beside what the paper says of the parts."""
    head = ["sensor", "corner Hz", "band Hz", "noise", "drift", "unit", "lead at 5 Hz", "at 20 Hz"]
    rows = []
    for file in sorted((root() / DATA / "sensors").glob("*.toml")):
        one = tomllib.loads(file.read_text(encoding="utf-8"))
        numbers = (one.get(key, 0.0) for key in ("corner_Hz", "band_Hz", "noise", "drift"))
        leads = (f"{lead_deg(one, freq_Hz):.2f} deg" for freq_Hz in (5.0, 20.0))
        rows.append([one["name"], *(f"{value:g}" for value in numbers), one["unit"], *leads])
    return format_table(head, rows, (0, 5))


def loop_table(mean_pct: Any, freqs: tuple[float, ...]) -> str:
    head = ["displacement amplitude, reduction %", *(f"{freq_Hz:g} Hz" for freq_Hz in freqs)]
    says = {
        "stated": "333B32, the board states its corner",
        "unstated": "333B32, nothing stated",
        "ideal": "ideal sensor with the same noise",
    }
    return format_table(
        head,
        [
            [says[case], *(f"{value:.2f}" for value in row)]
            for case, row in zip(CASES, mean_pct, strict=True)
        ],
    )


def measure(effort: Effort) -> Measured:
    freqs = FREQS_Hz[:1] if effort.is_quick else FREQS_Hz
    seeds = range(effort.seed, effort.seed + (1 if effort.is_quick else SEEDS))
    with tempfile.TemporaryDirectory() as folder:
        pct = reductions_pct(Bench(), Path(folder), seeds, freqs)
    mean_pct = pct.mean(axis=2)
    stated, unstated, ideal = (float(row[0]) for row in mean_pct)
    values = {
        "sensor_stated_5Hz_pct": stated,
        "sensor_unstated_5Hz_pct": unstated,
        "sensor_ideal_5Hz_pct": ideal,
        "sensor_stated_loss_5Hz_pt": ideal - stated,
    }
    reported = {
        case: {f"{freq_Hz:g}Hz": float(value) for freq_Hz, value in zip(freqs, row, strict=True)}
        for case, row in zip(CASES, mean_pct, strict=True)
    }
    reported["spread_pt"] = float(np.ptp(pct, axis=2).max())
    reported["lead_5Hz_deg"] = lead_deg(read(DATA / "sensors/pcb_333B32.toml"), 5.0)
    return Measured(values, reported, (parts_table(), loop_table(mean_pct, freqs)))
