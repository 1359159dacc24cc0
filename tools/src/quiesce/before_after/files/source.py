"""What every kind of recording offers."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.nearest import listed
from quiesce.base.paths import shown
from quiesce.before_after.motion import Scale


@dataclass(frozen=True)
class Origin:
    """Where a recording comes from, for the page. parameters: the controller's, by name."""

    kind: str
    facts: Mapping[str, str] = field(default_factory=dict)
    parameters: Mapping[str, int] = field(default_factory=dict)
    doubts: tuple[str, ...] = ()


class Source(ABC):
    """One file. scales: of each channel; None where its unit is unknown or none of motion."""

    file: Path
    scales: dict[str, Scale | None]
    origin: Origin

    @abstractmethod
    def samples(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Seconds and values, as they stand in the file, of a channel that there is. UsageError
        where they are no numbers."""

    def known(self, name: str) -> str:
        """The channel of this name. UsageError where there is none."""
        if name not in self.scales:
            raise UsageError(
                f"{shown(self.file)}: no channel '{name}'; {listed(name, self.scales)}"
            )
        return name
