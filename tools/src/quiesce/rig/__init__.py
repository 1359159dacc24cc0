"""A rig by its variables, wherever it is: in the computer, or a controller on a bus.

with quiesce.rig.open("host") as rig:
    rig.stimulus("sine", freq_Hz=11.5)
    rig.read("status/rms_um_s2")
"""

from quiesce.rig.access import Rig
from quiesce.rig.capture import Series, Trigger
from quiesce.rig.opening import open_rig as open
from quiesce.rig.options import RigSetup

__all__ = ["Rig", "RigSetup", "Series", "Trigger", "open"]
