"""FMUs: are they what the standard asks for, have they the bench's words, what does a step cost."""

import tempfile
import time
from pathlib import Path

import numpy as np
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.engine.bench import Bench
from quiesce.engine.trace import read_trace
from quiesce.fmu.cosim import CONTROLLER, run
from quiesce.fmu.pack import VERSIONS, pack
from quiesce.fmu.slave import Slave

from quiesce_benchmarks.part import Effort, Measured

TITLE = "FMUs of plant, damper and controller"
FIGURES = (
    ("fmu_validated", "1", 6.0, "higher"),
    ("fmu_mismatched_words", "1", 0.0, "lower"),
    ("fmu_step_us", "us", 15.0, "lower", False),
)

DATA = root() / "sim_hil/data"
TICK_s = 1e-3
WORD = "word of telemetry"
# Scenario, board and law of closed loops.
LOOPS = (
    ("sine_10Hz", None, "phase"),
    ("base_pulse", None, "fuzzy"),
    ("step_10_20Hz", None, "fuzzy_selftune"),
    ("mrd_mre_10Hz", "mrd_mre_2014", "constant"),
)
SECONDS, QUICK_SECONDS = 3.9, 1.5
STEPS, REPEATS = 5000, 7


def measure(effort: Effort) -> Measured:
    with tempfile.TemporaryDirectory(prefix="quiesce-fmu-") as temporary:
        folder = Path(temporary)
        checked = [validated(folder, kind, version) for kind in KINDS for version in VERSIONS]
        loops = LOOPS[:2] if effort.is_quick else LOOPS
        seconds = QUICK_SECONDS if effort.is_quick else SECONDS
        compared = [
            [name, law, f"{version}.0", *mismatched(folder, name, board, law, version, seconds)]
            for name, board, law in loops
            for version in VERSIONS
        ]
        step_us = controller_step_us(folder)
    head = ["scenario", "law", "FMI", "words", "differ"]
    said = [
        [kind, f"{version}.0", "; ".join(bad) or "no problem"] for kind, version, bad in checked
    ]
    return Measured(
        {
            "fmu_validated": float(sum(not problems for _, _, problems in checked)),
            "fmu_mismatched_words": float(sum(row[-1] for row in compared)),
            "fmu_step_us": step_us,
        },
        {"fmu_words": sum(row[-2] for row in compared)},
        (
            format_table(["kind", "FMI", "fmpy"], said, left=(0, 1, 2)),
            format_table(head, [list(map(str, row)) for row in compared], left=(0, 1, 2)),
        ),
    )


# Of each: words and files of the bench.
KINDS: dict[str, tuple[list[str], dict[str, Path]]] = {
    "controller": (["--law", "phase"], {"--plant": DATA / "plants/squeeze_2012.toml"}),
    "plant": (["--law", "off"], {"--plant": DATA / "plants/squeeze_2012.toml"}),
    "damper": ([], {"--damper": DATA / "dampers/utfsm_network.toml"}),
}


def validated(folder: Path, kind: str, version: str) -> tuple[str, str, list[str]]:
    from fmpy.validation import validate_fmu

    words, files = KINDS[kind]
    file = folder / f"{kind}_{version}.fmu"
    pack(kind, words, files, version, kind, file)
    return kind, version, validate_fmu(str(file))


def mismatched(
    folder: Path, name: str, board: str | None, law: str, version: str, seconds: float
) -> tuple[int, int]:
    """Words of telemetry of plant and controller as FMUs, and how many are not the bench's."""
    scenario = DATA / f"scenarios/{name}.toml"
    wired = (
        {"--board": DATA / f"boards/{board}.toml"}
        if board
        else {"--plant": DATA / "plants/squeeze_2012.toml"}
    )
    plant_file, controller_file = folder / "loop_plant.fmu", folder / "loop_controller.fmu"
    pack("plant", ["--law", "off"], {"--scenario": scenario}, version, name, plant_file)
    pack("controller", ["--law", law], wired, version, name, controller_file)
    ticks = round(seconds / TICK_s)
    with Slave(plant_file, {}, seconds) as plant, Slave(controller_file, {}, seconds) as controller:
        words = [
            one
            for one in controller.names("output")
            if controller.variable(one).description == WORD
        ]
        # What a tick answers is there once its step is over: one row later.
        done = run(plant, controller, {}, TICK_s, ticks + 1, words)
    trace_file = folder / "trace"
    Bench().call("run", "--scenario", str(scenario), "--law", law, "--trace", str(trace_file))
    trace = read_trace(trace_file, words)
    mask = 0xFFFFFFFF
    wrong = sum(
        int(
            (
                (done.columns[CONTROLLER + word][1:].astype(np.int64) & mask)
                != (trace[word][:ticks].astype(np.int64) & mask)
            ).sum()
        )
        for word in words
    )
    return ticks * len(words), wrong


def controller_step_us(folder: Path) -> float:
    """Set a sample, step, get the current, by fmpy's own calls: the fastest of some runs."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    unpacked = extract(str(folder / "controller_2.fmu"), str(folder / "unpacked"))
    description = read_model_description(unpacked)
    references = {one.name: one.valueReference for one in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=unpacked,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="timed",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    sample, current = [references["sensor.accel_m_s2"]], [references["damper.current_cmd_A"]]
    samples = [[value] for value in np.sin(0.0628 * np.arange(STEPS)).tolist()]
    times, tick = [], 0
    for _ in range(REPEATS):
        start_s = time.perf_counter()
        for value in samples:
            fmu.setReal(sample, value)
            fmu.doStep(tick * TICK_s, TICK_s)
            fmu.getReal(current)
            tick += 1
        times.append(time.perf_counter() - start_s)
    fmu.freeInstance()
    return 1e6 * min(times) / STEPS
