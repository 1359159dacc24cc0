"""The rig of `quiesce live --sim` on its page: what viewers are told of it, what they may order.

A viewer is no user of this computer: files are those that the server was started with.
"""

from typing import Any

from quiesce.base.errors import UsageError
from quiesce.rig.records import Motion
from quiesce.rig.simulation import Simulation, bus_words

KEYS = ("control", "drive_V", "excite", "fault", "clear_faults")


class RigDesk:
    """simulation: at work for as long as the server is."""

    def __init__(self, simulation: Simulation, motions: list[Motion]) -> None:
        self.simulation = simulation
        self._motions = motions

    @property
    def failure(self) -> str:
        return self.simulation.failure

    def hello(self) -> dict[str, Any]:
        """What does not change."""
        return {
            **self.simulation.introduction,
            "records": [one.name for one in self._motions],
            "bus": bus_words(self.simulation.bus),
        }

    def told(self) -> dict[str, Any]:
        """Without the places of files."""
        state = dict(self.simulation.state)
        for motion in self._motions if state else ():
            state["excitation"] = state["excitation"].replace(
                str(motion.file.resolve()), motion.name
            )
        return state

    def obey(self, order: dict[str, Any]) -> str:
        """Waits for the answer; a line about it. UsageError where it is refused."""
        unknown = [key for key in order if key not in KEYS]
        if unknown or not order:
            raise UsageError(f"an order to the rig has keys of {', '.join(KEYS)}")
        excite = order.get("excite")
        if isinstance(excite, dict) and excite.get("kind") == "record":
            order = {**order, "excite": self._record(excite)}
        try:
            self.simulation.order(**order)
        except (RecursionError, OverflowError):
            raise UsageError("an order to the rig nests too deep, or has too large a number")
        return ""

    def _record(self, excite: dict[str, Any]) -> dict[str, Any]:
        """{"kind": "record", "record": NUMBER, "gain": X, "time_scale": X}."""
        number = excite.get("record")
        if type(number) is not int or not 0 <= number < len(self._motions):
            raise UsageError("no such record; the page lists those there are")
        gain, time_scale = excite.get("gain", 1.0), excite.get("time_scale", 1.0)
        return self._motions[number].order(gain, time_scale)
