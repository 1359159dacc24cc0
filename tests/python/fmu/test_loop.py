"""FMUs in motion: the bench's words, states that come back, errors in one line."""

import math
from pathlib import Path

import fmu_files
import numpy as np
import pytest
from conftest import ROOT, run_quiesce
from fmu_files import PLANT, SCENARIO
from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.engine.trace import read_trace
from quiesce.fmu.cosim import CONTROLLER, run
from quiesce.fmu.slave import Slave

fmu = fmu_files.fmu  # the fixture
TICK_s = 1e-3
TICKS = 3000
WORD = "word of telemetry"
BOARD_RIG = (
    ROOT / "sim_hil/data/scenarios/mrd_mre_10Hz.toml",
    ROOT / "sim_hil/data/boards/mrd_mre_2014.toml",
)


def words_of(controller: Slave) -> list[str]:
    outputs = controller.names("output")
    return [name for name in outputs if controller.variable(name).description == WORD]


def mismatched(plant_file: Path, controller_file: Path, trace_file: Path) -> tuple[int, int]:
    """Words of telemetry of the co-simulation that differ from the bench's; of how many."""
    with Slave(plant_file, {}, 10.0) as plant, Slave(controller_file, {}, 10.0) as controller:
        words = words_of(controller)
        # One row later: what a tick answers is there once its step is over.
        done = run(plant, controller, {}, TICK_s, TICKS + 1, words)
    trace = read_trace(trace_file, words)
    mask = 0xFFFFFFFF
    wrong = 0
    for word in words:
        ours = done.columns[CONTROLLER + word][1:].astype(np.int64) & mask
        bench = trace[word][:TICKS].astype(np.int64) & mask
        wrong += int((ours != bench).sum())
    return wrong, TICKS * len(words)


@pytest.mark.parametrize("version", ["2", "3"])
def test_closed_loop_has_the_benchs_words(fmu, version, tmp_path):
    trace = tmp_path / "trace"
    Bench().call("run", "--scenario", str(SCENARIO), "--law", "phase", "--trace", str(trace))
    wrong, words = mismatched(fmu("plant", version), fmu("controller", version), trace)
    assert wrong == 0
    assert words >= 30 * TICKS


def test_closed_loop_of_a_board_has_the_benchs_words(tmp_path):
    """Several sensors with rates and latencies of their own, several dampers."""
    scenario, board = BOARD_RIG
    files = {"plant": tmp_path / "plant.fmu", "controller": tmp_path / "controller.fmu"}
    for kind, words in (
        ("plant", ["--scenario", scenario]),
        ("controller", ["--board", board, "--law", "constant"]),
    ):
        result = run_quiesce(tmp_path, "fmu", kind, *words, "-o", files[kind])
        assert result.returncode == 0, result.stderr
    trace = tmp_path / "trace"
    Bench().call("run", "--scenario", str(scenario), "--law", "constant", "--trace", str(trace))
    wrong, words = mismatched(files["plant"], files["controller"], trace)
    assert wrong == 0
    assert words >= 30 * TICKS


class Driven:
    """A slave whose inputs move."""

    def __init__(self, slave: Slave) -> None:
        self.slave = slave
        self.inputs = slave.names("input")
        self._write = slave.writer(self.inputs)
        self.read = slave.reader(slave.names("output"))

    def run(self, start: int, stop: int) -> None:
        for tick in range(start, stop):
            self._write([self._value(name, 0.06 * tick) for name in self.inputs])
            self.slave.step(tick * TICK_s, TICK_s)

    @staticmethod
    def _value(name: str, angle: float) -> float:
        if name.endswith(("accel_m_s2", "force_N")):
            return math.sin(angle)
        if name == "velocity_m_s":
            return 0.06 * math.cos(angle)
        if name == "stroke_m":
            return 1e-3 * math.sin(angle)
        if name.endswith("current_cmd_A"):
            return 0.5 + 0.5 * math.sin(0.1 * angle)
        is_off = name in ("estop", "fault_reset") or name.endswith("current_is_measured")
        return 0.0 if is_off else 1.0


@pytest.mark.parametrize("version", ["2", "3"])
@pytest.mark.parametrize("kind", ["controller", "plant", "pushed", "damper"])
def test_state_comes_back_in_every_bit_here_and_elsewhere(fmu, kind, version):
    file = fmu(kind, version)
    with Slave(file, {}, 10.0) as first, Slave(file, {}, 10.0) as second:
        one, other = Driven(first), Driven(second)
        one.run(0, 1500)
        saved, at_saving = first.save(), one.read()
        one.run(1500, 2500)
        end = one.read()
        assert end != at_saving
        for again in (one, other):
            again.slave.load(saved)
            assert again.read() == at_saving
            again.run(1500, 2500)
            assert again.read() == end


def test_time_of_an_fmu_can_be_read_and_comes_back_with_a_state(fmu):
    with Slave(fmu("plant", "3"), {}, 1.0) as plant:
        time_s = plant.reader(["time"])
        assert time_s() == [0.0]
        plant.step(0.0, 0.25)
        saved = plant.save()
        plant.step(0.25, 0.5)
        assert time_s() == [0.75]
        plant.load(saved)
        assert time_s() == [0.25]


def test_damaged_or_strange_state_is_refused_and_changes_nothing(fmu):
    with Slave(fmu("controller", "3"), {}, 1.0) as one, Slave(fmu("plant", "3"), {}, 1.0) as plant:
        driven = Driven(one)
        driven.run(0, 700)
        saved, values = one.save(), driven.read()
        for place in (0, 5, len(saved) // 2, len(saved) - 1):
            flipped = bytearray(saved)
            flipped[place] ^= 0x10
            with pytest.raises(UsageError, match="damaged"):
                one.load(bytes(flipped))
        with pytest.raises(UsageError, match="damaged"):
            one.load(saved[:-40])
        with pytest.raises(UsageError, match="damaged"):
            one.load(b"")
        with pytest.raises(UsageError, match="another model"):
            one.load(plant.save())
        assert driven.read() == values
        driven.run(700, 900)
        end = driven.read()
        one.load(saved)
        driven.run(700, 900)
        assert driven.read() == end


def test_parameters_that_are_live_change_while_it_runs(fmu):
    starts = {"param.rms_window_ms": 500, "param.constant_current_mA": 2000}
    with Slave(fmu("constant", "2"), starts, 10.0) as controller:
        driven = Driven(controller)
        driven.run(0, 500)
        with pytest.raises(UsageError, match="fixed"):
            controller.writer(["param.rms_window_ms"])([1000])
        with pytest.raises(UsageError, match="may be 0 .. 20000"):
            controller.writer(["param.constant_current_mA"])([30000])
        driven.run(500, 1500)
        current_A = controller.reader(["damper.current_cmd_A"])
        assert current_A() == [2.0]
        controller.writer(["param.constant_current_mA"])([700])
        driven.run(1500, 2500)
        assert current_A() == pytest.approx([0.7])


def test_nan_is_no_sample(fmu):
    with Slave(fmu("controller", "2"), {}, 10.0) as controller:
        write = controller.writer(["sensor.accel_m_s2"])
        for tick in range(1000):
            write([math.nan if tick > 600 else math.sin(0.06 * tick)])
            controller.step(tick * TICK_s, TICK_s)
        bad, fault = controller.reader(["bad_sample_count", "fault"])()
    assert bad + fault > 0


def test_steps_of_any_length_run_the_ticks_that_are_due(fmu):
    with (
        Slave(fmu("controller", "2"), {}, 10.0) as one,
        Slave(fmu("controller", "2"), {}, 10.0) as two,
    ):
        for k in range(100):
            one.step(k * 0.0025, 0.0025)
        two.step(0.0, 0.25)
        ticks = [slave.reader(["tick"])()[0] for slave in (one, two)]
    assert ticks == [250, 250]


def test_a_controller_on_a_strange_plant_by_wires(fmu, tmp_path):
    result = run_quiesce(
        tmp_path, "fmu", "run", fmu("plant", "3"), "--law", "phase", "--plant", PLANT,
        "--seconds", "4", "--compare", "--out", "out",
        "--wire", "sensor.accel_m_s2=structure.accel_m_s2*1.0+0.0",
        "--wire", "damper.current_cmd_A=damper.current_cmd_A*1", "--start", "seed=7",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    row = next(line for line in result.stdout.splitlines() if "structure.displacement_m" in line)
    assert float(row.split()[-1]) < 0.9  # quieter than with the drivers off
    head = (tmp_path / "out/run.csv").read_text().splitlines()[0]
    assert head.startswith("t_s,plant.sensor.accel_m_s2")
    assert (tmp_path / "out/run.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--wire", "nonsense"], "expected INPUT=OUTPUT"),
        (["--wire", "sensor.accel_m_s2=force_N*x"], "expected INPUT=OUTPUT"),
        (["--wire", "sensor.accel_m_s2=force_N*nan"], "expected INPUT=OUTPUT"),
        (["--wire", "sensor.accel_m_s2=nowhere"], "nowhere"),
        (["--wire", "nowhere=force_N"], "nowhere"),
        ([], "nothing goes into sensor.accel_m_s2"),
        (["--start", "force_factor"], "expected NAME=VALUE"),
        (["--start", "nowhere=1"], "nowhere"),
        (["--start", "force_factor=-1"], "force_factor = -1: it may be 0 .. 100"),
        (["--keep", "nowhere", "--wire", "sensor.accel_m_s2=force_N"], "nowhere"),
        (["--seconds", "0"], "--seconds"),
    ],
)
def test_run_refuses_in_one_line(fmu, tmp_path, words, said):
    result = run_quiesce(tmp_path, "fmu", "run", fmu("damper", "2"), "--out", "out", *words)
    assert result.returncode == 2, result.stdout
    assert said in result.stderr.strip().splitlines()[-1]
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x05\x06" + bytes(18)])
def test_run_refuses_what_is_no_fmu(tmp_path, content):
    (tmp_path / "x.fmu").write_bytes(content)
    result = run_quiesce(tmp_path, "fmu", "run", "x.fmu", "--out", "out")
    assert result.returncode == 2
    assert "x.fmu: " in result.stderr.strip().splitlines()[-1]
    assert "Traceback" not in result.stderr


def test_another_version_of_the_description_is_refused(fmu, tmp_path):
    """The library of one FMU in another one's archive."""
    import shutil
    import zipfile

    mixed = tmp_path / "mixed.fmu"
    shutil.copyfile(fmu("damper", "2"), mixed)
    with zipfile.ZipFile(fmu("damper", "2")) as packed:
        entries = {name: packed.read(name) for name in packed.namelist()}
    with zipfile.ZipFile(fmu("pushed", "2")) as packed:
        entries["resources/fmu.toml"] = packed.read("resources/fmu.toml")
    with zipfile.ZipFile(mixed, "w") as packed:
        for name, data in entries.items():
            packed.writestr(name, data)
    with pytest.raises(UsageError, match="of different FMUs"):
        Slave(mixed, {}, 1.0)
