"""The tools' own client on a controller's line: parameters, tables."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from quiesce.base.errors import BenchFailure
from quiesce.can.buses import Bus
from quiesce.can.database import load
from quiesce.can.link import Link
from quiesce.can.parameters import settings_of
from quiesce.can.services import DONE
from quiesce.can.tables import Tables
from quiesce.table.file import table_bytes

from quiesce_benchmarks.tables.line import HELD, RUNNING, Line

# Samples of a busy machine come late; steps of the current are to show, were there any.
SETTINGS = {
    "sensor_max_age_ticks": "1000",
    "sensor_stuck_ticks": "0",
    "sensor_recover_ticks": "1",
    "slew_mA_s": "50000",
    "unlock_current_mA": "0",
    "phase_blend_ms": "0",
}
SLEW_mA = 50  # a tick
ARM_TICKS = 12_000
SEEN_TICKS = 300  # three periods of the vibration
NEAR = 0.02  # of a current
STAGE_S, APPLY_S, SAVE_S = 2.0, 3.0, 10.0  # an emulator on a busy machine takes its time


@dataclass
class Client:
    line: Line
    tables: Tables

    def set(self, settings: Mapping[str, str]) -> None:
        """In effect and kept. BenchFailure where it is refused."""
        words = [f"{name}={value}" for name, value in {**SETTINGS, **settings}.items()]
        for index, value in settings_of(words).items():
            self._must("STAGE", index, value, reply_s=STAGE_S)
        self._must("APPLY", reply_s=APPLY_S)
        self._must("SAVE", reply_s=SAVE_S, tries=2)

    def use(self, road: str, words: Sequence[int]) -> None:
        """Sends a table and has it used. BenchFailure."""
        self.tables.send(table_bytes(words), words[1])
        self.tables.commit(road, words[1])

    def arm(self) -> None:
        """It runs as soon as it has what it needs."""
        self.line.is_to_arm = True
        self.line.wait(lambda: self.line.state in HELD, ARM_TICKS, "armed")

    def disarm(self) -> None:
        self.line.is_to_arm = False
        self.line.wait(lambda: self.line.state not in RUNNING, ARM_TICKS, "not RUN")

    def see(self, current_mA: int) -> None:
        """Until this is the largest current of some periods. BenchFailure: it does not come."""
        line = self.line
        begin = len(line.demands) + SEEN_TICKS

        def holds() -> bool:
            found = line.largest_mA(SEEN_TICKS)
            return len(line.demands) > begin and abs(found - current_mA) <= NEAR * current_mA

        try:
            line.wait(holds, line.patience_ticks, f"{current_mA} mA")
        except BenchFailure as error:
            raise BenchFailure(f"{error}, but {line.largest_mA(SEEN_TICKS)} mA")

    def _must(self, operation: str, index: int = 0, value: int = 0, **patience: float) -> None:
        reply = self.tables.services.ask(operation, index, value, **patience)  # type: ignore[arg-type]
        result = "no reply" if reply is None else reply.result
        if result != DONE:
            raise BenchFailure(f"{operation} {index} {value}: {result}")


@contextlib.contextmanager
def client_of(line: Line) -> Iterator[Client]:
    with Link(Bus("slcan", line.client, None, ())) as link:
        yield Client(line, Tables(link, load()))
