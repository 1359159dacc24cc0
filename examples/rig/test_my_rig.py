"""One test file for every rig: docs/howto/test-a-rig.md.

pytest -p quiesce.rig.plugin examples/rig                              # in the computer
pytest -p quiesce.rig.plugin examples/rig --rig socketcan:can0         # a controller on a bus
"""

import pytest
from quiesce.base.errors import UsageError
from quiesce.rig import Rig, Trigger


def test_the_controller_is_at_work(rig: Rig) -> None:
    rig.wait(Trigger("status/state", equal="RUN"), 30.0)
    assert rig.read("status/fault") == "NONE"


def test_its_demand_stays_below_its_limit(rig: Rig) -> None:
    limit_mA = rig.read("parameters/max_current_mA")
    demand = rig.capture(["current_demand/current_cmd_mA"], length_s=1.0)
    values_mA = demand["current_demand/current_cmd_mA"].values
    assert len(values_mA) > 100
    assert values_mA.max() <= limit_mA


def test_it_quiets_the_resonance(rig: Rig) -> None:
    try:
        rig.stimulus("sine", freq_Hz=11.5, drive_V=0.05)
    except UsageError:
        pytest.skip("nothing here shakes it on order")
    rig.write("rig/control", False)
    off = rig.capture(["status/rms_um_s2"], length_s=5.0)["status/rms_um_s2"].values[-1]
    rig.write("rig/control", True)
    on = rig.capture(["status/rms_um_s2"], length_s=5.0)["status/rms_um_s2"].values[-1]
    assert on < 0.8 * off
