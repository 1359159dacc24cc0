"""Who gives the enable over CAN: OperatorCommand, again and again, whatever else is going on."""

import threading
from collections.abc import Callable

from quiesce.can.database import Database
from quiesce.can.e2e import ALIVE_PERIOD, protect

MESSAGE = "OperatorCommand"
PRESSED_FRAMES = 2  # that a press has to be seen in


class Operator:
    """Entered: sends, at first without the enable, whose edge is what arms. When it goes, however
    that came about, the controller's timeout takes the enable away."""

    def __init__(self, send: Callable[[int, bytes], object], database: Database) -> None:
        message = database.by_name[MESSAGE]
        assert message.protection is not None
        self._send_frame = send
        self._database = database
        self._message = message
        self._layout = message.protection
        self._alive = 0
        self._is_enabled = False
        self._resets = 0  # frames that press fault_reset, yet to come
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "Operator":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.disable()
        self._is_over.set()
        self._thread.join()

    def enable(self) -> None:
        self._is_enabled = True

    def disable(self) -> None:
        """With the next frame: one out of its cycle would be somebody else's."""
        self._is_enabled = False

    def acknowledge(self) -> None:
        """Presses fault_reset in the next frames, then lets it go; the frame after them acts."""
        self._resets = PRESSED_FRAMES

    def _run(self) -> None:
        while not self._is_over.wait(self._message.cycle_ms / 1000.0):
            is_reset = self._resets > 0
            self._resets = max(0, self._resets - 1)
            data = self._database.encode(
                MESSAGE, enable=int(self._is_enabled), fault_reset=int(is_reset)
            )
            self._alive = (self._alive + 1) % ALIVE_PERIOD
            self._send_frame(self._message.frame_id, protect(self._layout, self._alive, data))
