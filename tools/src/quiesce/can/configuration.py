"""What a log says of the controller that it is of: version, parameters, tables."""

from typing import Any

from quiesce.can.database import Database
from quiesce.can.parameters import name_of
from quiesce.can.roads import ROADS
from quiesce.can.services import IDENTIFICATION, REPLY, REQUEST, VERSION_PARTS
from quiesce.can.tables import CRC, WORD


class Configuration:
    """Of the frames that are taken, in their order; the last word on each counts. parameters: by
    name; tables: CRC by road, of those that somebody asked for."""

    def __init__(self, database: Database) -> None:
        self.parameters: dict[str, int] = {}
        self.tables: dict[str, int] = {}
        self.identification: dict[str, int] = {}
        self._database = database
        self._ids = {
            database.by_name[name].frame_id: name for name in (IDENTIFICATION, REPLY, REQUEST)
        }
        self._asked: dict[int, int] = {}  # alive counter: what TABLE_INFO was to tell

    def take(self, frame: Any) -> None:
        name = self._ids.get(frame.arbitration_id)
        if name is None or len(frame.data) != self._database.by_name[name].length:
            return
        raw = self._database.raw(frame.arbitration_id, bytes(frame.data))
        if name == IDENTIFICATION:
            self.identification = raw
        elif name == REQUEST:
            self._asked[raw["alive"]] = raw["param_value"]
        else:
            self._answer(raw)

    def _answer(self, raw: dict[str, int]) -> None:
        operation = self._database.label(REPLY, "operation", raw["operation"])
        if self._database.label(REPLY, "result", raw["result"]) != "DONE":
            return
        if operation == "READ":
            self.parameters[name_of(raw["param_index"])] = raw["param_value"]
        elif operation == "TABLE_INFO" and self._asked.get(raw["alive"]) == CRC:
            if raw["param_index"] < len(ROADS):  # a newer firmware may have more
                self.tables[ROADS[raw["param_index"]]] = raw["param_value"] % WORD

    def facts(self) -> dict[str, str]:
        """For people; empty where the log says nothing."""
        found = {}
        if self.identification:
            numbers = (self.identification[f"version_{part}"] for part in VERSION_PARTS)
            version = ".".join(map(str, numbers))
            found["firmware"] = f"version {version}"
            found["parameters' hash"] = f"{self.identification['param_hash']:08X}"
        if self.parameters:
            found["parameters"] = f"{len(self.parameters)} in the log"
        return found | {f"table on road {road}": f"{crc:08X}" for road, crc in self.tables.items()}
