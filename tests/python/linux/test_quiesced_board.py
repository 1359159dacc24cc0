"""The controller program with several sensors and dampers of a board, all on one bus."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from quiesced_peer import ROOT, Quiesced, on_a_pty
from quiesced_steps import (
    DONE,
    FAULT,
    RUN,
    SAFE,
    disarm,
    in_a_row,
    index_of,
    killed,
    start_running,
)

SENSORS = ("floor_accel", "roof_accel", "upper_stroke")
DAMPERS = {"lower": "CurrentDemand", "upper": "CurrentDemand1"}
SAFE_mA = {"lower": 40, "upper": 60}
CEILING_mA = 2000
PARAMETERS = """law = "constant"
constant_current_mA = 5000
max_current_mA = 5000
slew_mA_s = 100000
"""
SHORT = 3  # of CurrentMeasured's driver_status


def board_text() -> str:
    """Two storeys, patient with a machine that has other work."""
    text = (ROOT / "sim_hil/data/boards/two_storeys.toml").read_text()
    assert text.count("safe_mA = 0") == 2 and text.count(f"ceiling_mA = {CEILING_mA}") == 2
    for current_mA in SAFE_mA.values():
        text = text.replace("safe_mA = 0", f"safe_mA = {current_mA}", 1)
    return text.replace("[[sensor]]", "[[sensor]]\nmax_age_us = 2000000\nstuck_us = 0")


def tables() -> str:
    sensors = "".join(f'[[sensor]]\nname = "{name}"\nsource = "can"\n' for name in SENSORS)
    dampers = "".join(f'[[damper]]\nname = "{name}"\noutput = "can"\n' for name in DAMPERS)
    return '[board]\nfile = "rig.board.toml"\n' + sensors + dampers


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Quiesced]:
    with on_a_pty(tmp_path, parameters=PARAMETERS) as under_test:
        (tmp_path / "rig.board.toml").write_text(board_text())
        text = under_test.config.read_text()
        for old, new in (
            ('[accel]\nsource = "can"\n[current]\noutput = "can"\n', tables()),
            ("sensor_max_age_ticks = 1000\nsensor_stuck_ticks = 0\n", ""),
        ):
            assert text.count(old) == 1
            text = text.replace(old, new)
        under_test.config.write_text(text)
        under_test.peer.sensors = len(SENSORS)
        yield under_test


def wait_currents(rig: Quiesced, currents_mA: dict[str, int], is_enabled: bool, after: int) -> None:
    for damper, message in DAMPERS.items():
        expected = (currents_mA[damper], int(is_enabled))
        rig.peer.wait(
            message,
            lambda s, expected=expected: (s["current_cmd_mA"], s["driver_is_enabled"]) == expected,
            after,
        )


def test_every_damper_reaches_its_ceiling_and_leaves_with_a_farewell(rig: Quiesced) -> None:
    start_running(rig)
    wait_currents(rig, dict.fromkeys(DAMPERS, CEILING_mA), True, 0)
    rig.signal(signal.SIGUSR1)
    rig.peer.wait("Identification", after=rig.peer.count())
    after = rig.peer.count()
    assert rig.stop() == 0
    wait_currents(rig, SAFE_mA, False, after)
    status = rig.status()
    assert [one["name"] for one in status["sensors"]] == list(SENSORS)
    assert {one["source"] for one in status["sensors"]} == {"can"}
    assert [one["name"] for one in status["dampers"]] == list(DAMPERS)
    assert status["can"]["rejected_crc"] == status["can"]["rejected_shape"] == 0


def test_no_parameter_raises_a_ceiling(rig: Quiesced) -> None:
    start_running(rig)
    disarm(rig)
    for name in ("max_current_mA", "constant_current_mA"):
        reply = rig.peer.request("STAGE", index_of(name), 20000)
        assert reply.signals["result"] == DONE
    assert rig.peer.request("APPLY").signals["result"] == DONE
    rig.peer.operator = {"enable": 1}
    after = rig.peer.count()
    wait_currents(rig, dict.fromkeys(DAMPERS, CEILING_mA), True, after)
    rig.peer.wait("Identification", after=rig.peer.count())
    demands = [f for f in rig.peer.frames if f.name in DAMPERS.values()]
    assert max(f.signals["current_cmd_mA"] for f in demands) == CEILING_mA


def test_one_driver_that_fails_stops_all(rig: Quiesced) -> None:
    start_running(rig)
    after = rig.peer.count()
    rig.peer.send("CurrentMeasured1", driver_status=SHORT, current_meas_mA=0)
    rig.peer.wait_state(FAULT, after)
    wait_currents(rig, SAFE_mA, False, after)
    rig.peer.wait("Status", lambda s: s["fault"] == 12, after)


def test_the_tracked_sensor_is_missed(rig: Quiesced) -> None:
    start_running(rig)
    rig.peer.sensors = 1  # the floor's goes on, the roof's does not
    after = rig.peer.count()
    rig.peer.wait("CurrentDemand", in_a_row(1200, SAFE), after)  # SENSOR_LOST, TICK_LOST before it
    wait_currents(rig, SAFE_mA, True, after)
    rig.peer.sensors = len(SENSORS)
    rig.peer.wait_state(RUN, rig.peer.count())


def test_a_killed_controllers_dampers_are_all_made_safe(rig: Quiesced) -> None:
    start_running(rig)
    after = killed(rig)
    (rig.folder / "rig.board.toml").unlink()  # the one that ran is kept
    assert rig.run("--make-safe").returncode == 0
    wait_currents(rig, SAFE_mA, False, after)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('name = "upper_stroke"', 'name = "stroke"', 'the board has no sensor "stroke"'),
        ('file = "rig.board.toml"', 'file = "no.toml"', "no.toml"),
        ("tick_rate_Hz = 500", "tick_rate_Hz = 1000", "the bus would be 117.6 % full"),
        ("tick_rate_Hz = 500", "accel_polarity = 1", "comes from the board file"),
    ],
)
def test_refused(rig: Quiesced, old: str, new: str, words: str) -> None:
    text = rig.config.read_text()
    assert old in text
    rig.config.write_text(text.replace(old, new))
    result = rig.run()
    assert result.returncode == 2 and words in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert rig.run("--check").returncode == 2


def test_check_lists_sensors_dampers_and_load(rig: Quiesced) -> None:
    result = rig.run("--check")
    assert result.returncode == 0
    for line in (
        "sensor roof_accel: can 0x031",
        "damper upper: can 0x011, ceiling 2000 mA, safe 60 mA",
    ):
        assert line in result.stdout.splitlines()
    assert "CAN load: 67.1 % at 500000 bit/s" in result.stdout
