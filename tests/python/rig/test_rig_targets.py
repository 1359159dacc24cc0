"""The rig in the computer with its controller as an image, as `quiesced`, as one that runs
already."""

import os
import signal
import tty
from pathlib import Path

import pytest
import quiesce.rig
import quiesce.rig.free
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import root
from quiesce.can.roads import LAW
from quiesce.can.tables import CRC
from quiesce.engine.linux_target import PtyBus, quiesced, running
from quiesce.engine.params import parameters
from quiesce.loading.sources import table_of
from quiesce.rig import Rig, RigSetup, Trigger
from quiesce.rig.free import changes
from quiesce.rig.options import IMAGE, LINUX
from quiesce.rig.programs import Quiesced, board_sections, configuration
from quiesce_benchmarks.live.rig import PATIENCE_S

RULES = root() / "sim_hil/data/rules/squeeze_2012_published.fcl"
SETTINGS = ("current_error_mA=600",)


@pytest.fixture(scope="module")
def rules(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("rules") / "mine.table"
    file.write_bytes(table_of("rules", RULES).data)
    return file


def set_up(rules: Path, **more: object) -> RigSetup:
    return RigSetup(law="fuzzy", settings=SETTINGS, tables=[("rules", rules)], **more)


def expect_it_has(rig: Rig, rules: Path) -> None:
    assert rig.read("parameters/law") == "fuzzy"
    assert rig.read("parameters/current_error_mA") == 600
    assert rig.tables().info(LAW, CRC) == table_of("rules", rules).crc


def expect_less_vibration(rig: Rig) -> None:
    rig.stimulus("sine", freq_Hz=11.5, drive_V=0.05)
    with_control = settled(rig, "on")
    rig.write("rig/control", False)
    rig.wait(Trigger("status/is_enabled", equal=0), PATIENCE_S)
    assert with_control < 0.9 * settled(rig, "off")


def settled(rig: Rig, which: str) -> float:
    """RMS of a whole window with control on or off, once there is one."""
    for _ in range(100):
        try:
            return float(rig.read(f"rig/vibration/{which}/displacement_um"))
        except BenchFailure:
            continue
    raise AssertionError(f"no window with control {which}")


@pytest.mark.parametrize("target", [IMAGE, LINUX])
def test_parameters_and_tables_reach_it_and_it_quiets_the_plant(target: str, rules: Path) -> None:
    with quiesce.rig.open(target, set_up(rules)) as rig:
        rig.wait(Trigger("status/state", equal="RUN"), PATIENCE_S)
        expect_it_has(rig, rules)
        expect_less_vibration(rig)
        rig.write("parameters/law", "constant")
        assert rig.read("parameters/law") == "constant"
    assert rig._simulation.failure == ""


@pytest.mark.parametrize("target", [IMAGE, LINUX])
def test_it_has_the_sensors_and_dampers_of_a_board(target: str) -> None:
    data = root() / "sim_hil/data"
    setup = RigSetup(
        data / "plants/two_storeys.toml",
        data / "boards/two_storeys.toml",
        law="constant",
        settings=["constant_current_mA=300"],
    )
    with quiesce.rig.open(target, setup) as rig:
        rig.wait(Trigger("status/state", equal="RUN"), PATIENCE_S)
        rig.wait(Trigger("current_demand1/current_cmd_mA", above=250.0), PATIENCE_S)


def test_a_controller_that_runs_already_is_set_up_and_waits_for_its_user(
    rules: Path, tmp_path: Path
) -> None:
    """With a sensor's scale that is another one's."""
    (tmp_path / "state").mkdir()
    config = tmp_path / "quiesced.toml"
    near, far = os.openpty()
    tty.setraw(far)
    text = configuration(os.ttyname(far), tmp_path, None)
    config.write_text(text + "\n[parameters]\naccel_scale_nm_s2 = 50000\n")
    try:
        with running([str(quiesced()), "--config", str(config)], tmp_path / "log") as process:
            with quiesce.rig.open("host", set_up(rules, can=f"slcan:fd:{near}")) as rig:
                expect_it_has(rig, rules)
                scale = next(one for one in parameters() if one["name"] == "accel_scale_nm_s2")
                assert rig.read("parameters/accel_scale_nm_s2") == scale["default"]
                assert rig.read("status/is_enabled") == 0 and not rig.read("rig/control")
                rig.write("rig/control", True)
                rig.wait(Trigger("status/is_enabled", equal=1), PATIENCE_S)
            assert process.poll() is None
    finally:
        os.close(near)
        os.close(far)


def test_the_end_of_quiesced_is_told_in_one_line() -> None:
    with quiesce.rig.open(LINUX) as rig:
        simulation = rig._simulation
        assert isinstance(simulation, quiesce.rig.free.FreeSimulation)
        process = simulation._controller._process
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        assert "quiesced ended with" in simulation.failure
        assert "\n" not in simulation.failure


def test_nobody_at_the_other_end_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quiesce.rig.free, "ANSWER_S", 0.5)
    with PtyBus() as bus:
        setup = RigSetup(can=f"slcan:{bus.paths[1]}")
        with (
            pytest.raises(UsageError, match="takes no bytes|no controller answers"),
            quiesce.rig.open("host", setup),
        ):
            pass


@pytest.mark.parametrize(
    ("setup", "why"),
    [
        ({"can": "slcan:tcp:127.0.0.1:1"}, "127.0.0.1:1"),
        ({"can": "nonsense"}, "is no CAN channel"),
        ({"can": "slcan:fd:77"}, "is no descriptor"),
        ({"can": "slcan:fd:x"}, "is no descriptor"),
    ],
)
def test_channels_that_are_none_are_told(setup: dict[str, str], why: str) -> None:
    with pytest.raises(UsageError, match=why), quiesce.rig.open("host", RigSetup(**setup)):
        pass


def test_targets_that_are_none_are_refused() -> None:
    with pytest.raises(UsageError, match="expected one of host, mps2, linux"):
        RigSetup(target="moon")
    with pytest.raises(UsageError, match="no target that is started here"):
        RigSetup(target=LINUX, can="socketcan:can0")


def test_a_board_that_is_none_is_refused(tmp_path: Path) -> None:
    for text in ("x = 1", "sensor = 3\ndamper = 4", "sensor = [1]\ndamper = [2]", "= ="):
        file = tmp_path / "board.toml"
        file.write_text(text)
        with pytest.raises(UsageError, match="no board"):
            board_sections(file)
    with pytest.raises(UsageError, match="no board"):
        Quiesced(tmp_path / "none.toml").__enter__()


def test_what_is_wanted_and_what_a_sensor_settles_changes() -> None:
    known = {one["name"]: one for one in parameters()}
    has = [one["default"] for one in parameters()]
    assert changes(has, {}) == {}
    has[known["accel_scale_nm_s2"]["index"]] += 1
    has[known["slew_mA_s"]["index"]] += 1
    scale = known["accel_scale_nm_s2"]
    assert changes(has, {}) == {scale["index"]: scale["default"]}
    law = known["law"]["index"]
    assert changes(has, {"law": 1})[law] == 1
    assert changes([], {"law": 2}) == {}
