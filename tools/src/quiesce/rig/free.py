"""A rig in the computer whose controller runs by itself, on a bus on which the plant is, too.

It gets its parameters and tables as any controller does, over its bus. One that was started here
is enabled then; what somebody else has started may have a real coil, and waits for its user.
"""

import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.can.buses import Bus
from quiesce.can.changes import apply
from quiesce.can.database import Database, load
from quiesce.can.link import Link
from quiesce.can.parameters import parameters
from quiesce.can.services import Services
from quiesce.can.tables import Tables
from quiesce.loading.load import put
from quiesce.loading.sources import table_of
from quiesce.rig.programs import Elsewhere, Quiesced, hurry
from quiesce.rig.simulation import Simulation

# Of the bench's options: what `quiesce can load` calls them.
ROADS = {"rules": "rules", "pulses": "pulses", "law-table": "law", "force-map": "tracker"}
# What a simulated sensor settles, whatever a controller had before.
OF_SENSOR = "accel_"
ANSWER_S = 20.0
STATUS, ARMED = "Status", ("ARMED", "RUN")
ARMED_S, LET_GO_S, ENABLE_TRIES = 1.0, 0.5, 6
BETWEEN_S = 0.2
TRIES = 100  # of a request: this computer may have no time for its controller for a while


class FreeSimulation(Simulation):
    def __init__(
        self,
        options: Sequence[str],
        tables: Sequence[tuple[str, Path]],
        bus: Bus,
        controller: Elsewhere | Quiesced,
    ) -> None:
        """options: of `quiesce_bench live`, without tables. tables: as RigSetup has them."""
        super().__init__(options, bus)
        self._tables = tables
        self._controller = controller
        self._database = load()
        self._running = ExitStack()

    def __enter__(self) -> "FreeSimulation":
        with ExitStack() as starting:
            controller = starting.enter_context(self._controller)
            self._options += ["--can", controller.channel, "--control", "off"]
            self._descriptors = tuple(controller.descriptors)
            super().__enter__()
            starting.push(super().__exit__)
            self.introduction["target"] = controller.name
            with Link(self.bus) as link:
                self._set_up(link)
                if isinstance(controller, Quiesced):
                    controller.hand_over()
                    self._enable(link)
            self._running = starting.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._running.close()

    @property
    def failure(self) -> str:
        of_plant = super().failure
        return "" if self.summary else self._controller.failure or of_plant

    def _started(self, process_id: int) -> None:
        hurry(process_id)

    def _set_up(self, link: Link) -> None:
        services = Services(link, self._database, tries=TRIES)
        self._await(services)
        settings = changes(services.read_all(), self.introduction["params"])
        if settings:
            apply(services, settings)
        for option, file in self._tables:
            put(Tables(link, self._database), table_of(ROADS[option], file), lambda _: None)

    def _enable(self, link: Link) -> None:
        """Gives the enable, again where the controller was not ready to take it: its rise has to
        come in IDLE. A fault that is there is for the user to see."""
        for _ in range(ENABLE_TRIES):
            self.order(control=True)
            if is_armed(link, self._database, ARMED_S):
                return
            self.order(control=False)
            is_armed(link, self._database, LET_GO_S)
        self.order(control=True)

    def _await(self, services: Services) -> None:
        """Until it tells who it is. UsageError where it never does."""
        end_s = time.monotonic() + ANSWER_S
        while True:
            try:
                services.understand()
                return
            except BenchFailure as error:
                if self.failure or time.monotonic() > end_s:
                    raise UsageError(self.failure or f"{self._controller.channel}: {error}")
            services.wait(BETWEEN_S)


def is_armed(link: Link, database: Database, wait_s: float) -> bool:
    """Whether a Status that comes within this time says so."""
    status = database.by_name[STATUS]
    end_s = time.monotonic() + wait_s
    while (left_s := end_s - time.monotonic()) > 0.0:
        event = link.receive(left_s)
        if getattr(event, "arbitration_id", None) != status.frame_id:
            continue
        data = bytes(event.data)
        if (
            len(data) == status.length
            and str(database.decode(status.frame_id, data)["state"]) in ARMED
        ):
            return True
    return False


def changes(has: Sequence[int], wanted: Mapping[str, int]) -> dict[int, int]:
    """By index: what a controller is to change that has these values, so that it has those that are
    wanted, and those of the sensor, which are at their defaults where they are not named."""
    out = {}
    for one in parameters():
        name, index = one["name"], one["index"]
        value = wanted.get(name, one["default"])
        is_meant = name in wanted or name.startswith(OF_SENSOR)
        if is_meant and index < len(has) and has[index] != value:
            out[index] = value
    return out
