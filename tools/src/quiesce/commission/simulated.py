"""A rig in the computer, which needs no hand."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import tomli_w

from quiesce.base.errors import BenchFailure
from quiesce.commission.folder import Folder
from quiesce.commission.site import clock_s, running, until_idle
from quiesce.commission.wants import Wants
from quiesce.plant.library import Plant
from quiesce.plant.variant import read_plant_data
from quiesce.plant_id.simulate import record
from quiesce.plant_id.sweep import Timeline, write_line
from quiesce.rig import Rig, RigSetup
from quiesce.rig import open as open_rig

NO_DAMPER = {"model": "viscous", "base_N_s_m": 0.0, "per_A_N_s_m": 0.0, "stroke_m": 1.0}
SEED = 1  # of the sensor's noise
BARE = "without_damper.toml"
TABLE = "loaded.table"


def own_site(wants: Wants, folder: Folder) -> "SimulatedSite":
    """On a rig of its own, whose controller has no memory: it starts with what earlier steps gave
    it. UsageError where the plant's file is none."""
    assert wants.plant is not None
    table = folder.path / TABLE
    setup = RigSetup(
        Path(wants.plant),
        law=str(folder.settings.get("law", "phase")),
        settings=[*wants.start, *_settings(folder)],
        tables=[("pulses", table)] if table.is_file() else [],
    )
    return SimulatedSite(open_rig("host", setup), wants, folder)


class SimulatedSite:
    is_simulated = True

    def __init__(self, rig: Rig, wants: Wants, folder: Folder) -> None:
        """rig: of the plant that is wanted. UsageError where that plant's file is none."""
        assert wants.plant is not None
        self.rig = rig
        self.limit_mA = limit_mA(wants)
        self._plant = Path(wants.plant)
        self._folder = folder

    def __enter__(self) -> "SimulatedSite":
        self.rig.__enter__()
        self.rig.write("rig/control", False)
        self.rig.write("rig/drive_V", 0.0)
        return self

    def __exit__(self, *error: object) -> None:
        self.rig.__exit__(*error)

    def shake(self, freq_Hz: float, drive_V: float) -> None:
        self.rig.stimulus("sine", freq_Hz=freq_Hz, drive_V=drive_V)

    def turn(self, gravity_g: float, how: str) -> None:
        self.rig.turn_over(gravity_g)

    def settle(self, length_s: float) -> None:
        until_s = clock_s(self) + length_s
        while clock_s(self) < until_s:
            pass  # each look waits for the rig's next state

    @contextmanager
    def armed(self, why: str) -> Iterator[None]:
        try:
            self.rig.write("rig/control", True)
            with running(self.rig):
                yield
        finally:
            self.rig.write("rig/control", False)
            if not until_idle(self.rig):
                raise BenchFailure("the controller still runs without its enable")

    def played(self, line: Timeline, name: str, has_damper: bool) -> None:
        """The plant answers by itself; the controller has no part in it."""
        file = self._plant
        if not has_damper:
            file = self._folder.path / BARE
            file.write_text(tomli_w.dumps(bare(self._plant)), encoding="utf-8")
        write_line(self._folder.path / f"{name}.csv", line, record(Plant(file), line, SEED))

    def mount_damper(self) -> None:
        """It is the plant's own again."""


def bare(plant: Path) -> dict[str, object]:
    """The plant's data, its damper taken off."""
    data = read_plant_data(plant)
    return {**data, "damper": NO_DAMPER, "coil": data.get("coil", {"rise_s": 0.0})}


def limit_mA(wants: Wants) -> int:
    """Of the plant's driver, or less where less is wanted. UsageError where its file is no
    plant's."""
    assert wants.plant is not None
    full_A = Plant(wants.plant).max_current_A
    return round(1e3 * min(full_A, wants.max_current_A or full_A))


def _settings(folder: Folder) -> list[str]:
    return [f"{name}={value}" for name, value in folder.settings.items() if name != "law"]
