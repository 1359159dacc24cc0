"""What a step is given."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import default_plant
from quiesce.commission.folder import Folder
from quiesce.commission.site import Site, give
from quiesce.commission.wants import Wants
from quiesce.plant.library import Plant

FOUND, TUNED = "found", "tuned"
RECORDING = "recording"  # .csv
DESIGNED = "plant.toml"


@dataclass(frozen=True)
class Work:
    """tell: a line of progress. lines: of the steps before, what each is and what came of it. A
    step that needs a rig has it in `site`."""

    wants: Wants
    folder: Folder
    tell: Callable[[str], None]
    opened: Callable[[], Site]
    lines: Sequence[tuple[str, str]] = ()

    @cached_property
    def site(self) -> Site:
        return self.opened()

    @property
    def path(self) -> Path:
        return self.folder.path

    def result(self, step: str) -> dict[str, Any]:
        """Of a step before this one."""
        return self.folder.results[step]

    def give(self, settings: dict[str, int | str]) -> None:
        """To the controller, and to the one that is started in its place. BenchFailure where it
        refuses."""
        give(self.site.rig, settings)
        self.folder.settings |= settings
        self.folder.save()

    @property
    def base_plant(self) -> Path:
        """What no recording can tell: sensor, driver, the damper's kind."""
        return Path(self.wants.base_plant or self.wants.plant or default_plant())

    @property
    def drive_V(self) -> float:
        """UsageError where nobody has said."""
        if self.wants.drive_V is not None:
            return self.wants.drive_V
        if self.wants.plant is None:
            raise UsageError("how strong may the shaker be? --drive V")
        return Plant(self.wants.plant).drive_V

    @property
    def trial_Hz(self) -> float:
        """Where something moves, as far as is known."""
        if self.wants.first_mode_Hz is not None:
            return self.wants.first_mode_Hz
        low_Hz, high_Hz = self.wants.band_Hz
        return float(f"{(low_Hz * high_Hz) ** 0.5:.3g}")
