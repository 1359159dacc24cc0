"""The freeze frame of the first fault, put together from its pages."""

from typing import Any

from quiesce.can.database import Database

MESSAGE = "FaultFreeze"
PAGES = 6
# Signals of the pages as people read them: title, unit, scale.
SHOWN = {
    "freeze_tick": ("tick", "", 1.0),
    "freeze_accel_um_s2": ("acceleration", "m/s2", 1e-6),
    "freeze_rms_um_s2": ("RMS", "m/s2", 1e-6),
    "freeze_freq_uHz": ("frequency", "Hz", 1e-6),
    "freeze_displacement_amp_nm": ("displacement", "mm", 1e-6),
    "freeze_current_cmd_mA": ("commanded current", "A", 1e-3),
    "freeze_current_law_mA": ("current that the law requested", "A", 1e-3),
    "freeze_current_meas_mA": ("measured current", "A", 1e-3),
}
# Values that another signal may say are none.
VALID_BY = {
    "freeze_freq_uHz": "freeze_freq_is_valid",
    "freeze_current_meas_mA": "freeze_current_is_measured",
}


class FirstFault:
    """Kept until a fault comes after a time without any."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._frame_id = database.by_name[MESSAGE].frame_id
        self._number: int | None = None  # of the freeze whose pages come now
        self._pages: dict[int, dict[str, Any]] = {}
        self._is_over = True
        self.frame: dict[str, Any] | None = None
        self.later = 0  # faults since that one

    def healthy(self) -> None:
        """The controller reports no fault: the next one is a first one."""
        self._is_over = True

    def take(self, frame_id: int, data: bytes) -> None:
        """Any trusted frame."""
        if frame_id != self._frame_id:
            return
        page = self._database.decode(frame_id, data)
        if not page:
            return
        if page["freeze_number"] != self._number:
            self._number, self._pages = page["freeze_number"], {}
        is_new = page["page"] not in self._pages
        self._pages[page["page"]] = page
        if is_new and len(self._pages) == PAGES:
            self._complete()

    def _complete(self) -> None:
        if not self._is_over:
            self.later += 1
            return
        signals = {name: value for one in self._pages.values() for name, value in one.items()}
        self._is_over, self.later = False, 0
        self.frame = {
            "fault": str(signals["freeze_fault"]),
            "state_before": str(signals["freeze_state"]),
            "values": [
                [title, round(signals[name] * scale, 6), unit]
                for name, (title, unit, scale) in SHOWN.items()
                if signals[VALID_BY.get(name, name)] or name not in VALID_BY
            ],
        }
