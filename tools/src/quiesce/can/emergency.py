"""Frames of EmergencyStop, one after the other."""

from quiesce.can.database import Database
from quiesce.can.e2e import ALIVE_PERIOD, protect

MESSAGE = "EmergencyStop"


class StopFrames:
    """Repeated by the caller until the controller reports fault ESTOP."""

    def __init__(self, database: Database) -> None:
        message = database.by_name[MESSAGE]
        assert message.protection is not None
        self.frame_id = message.frame_id
        self.cycle_s = message.cycle_ms / 1000.0
        self._layout = message.protection
        self._data = database.encode(MESSAGE, code=database.number(MESSAGE, "code", "STOP"))
        self._alive = 0

    def next(self) -> bytes:
        data = protect(self._layout, self._alive, self._data)
        self._alive = (self._alive + 1) % ALIVE_PERIOD
        return data
