"""What a rig in the computer is made of, as options of the bench's `live`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import default_plant
from quiesce.engine.bench import live_image, setting_options

LAW = "phase"
HOST, IMAGE, LINUX = "host", "mps2", "linux"
TARGETS = (HOST, IMAGE, LINUX)


@dataclass(frozen=True)
class RigSetup:
    """plant: the one that ships where it is None. board: where it has several dampers. target:
    where its controller runs. can: a channel to one that runs already, in its place."""

    plant: Path | None = None
    board: Path | None = None
    law: str = LAW
    settings: Sequence[str] = ()  # NAME=VALUE
    tables: Sequence[tuple[str, Path]] = ()  # of the bench: ("rules", file)
    target: str = HOST
    can: str | None = None

    def __post_init__(self) -> None:
        if self.target not in TARGETS:
            raise UsageError(f"target {self.target!r}: expected one of {', '.join(TARGETS)}")
        if self.can is not None and self.target != HOST:
            raise UsageError("a controller at a CAN channel is no target that is started here")

    @property
    def is_free(self) -> bool:
        """Whether the controller runs by itself, with a clock of its own."""
        return self.target == LINUX or self.can is not None

    def words(self) -> list[str]:
        """UsageError where a file is not there."""
        plant = self.plant or default_plant()
        files = [("plant", plant), *(() if self.is_free else self.tables)]
        if self.board is not None:
            files.append(("board", self.board))
        words = ["--law", self.law, *setting_options(self.settings)]
        for option, file in files:
            if not file.is_file():
                raise UsageError(f"{file}: there is no such file")
            words += [f"--{option}", str(file)]
        if self.target == IMAGE:
            words += ["--image", str(live_image())]
        return words
