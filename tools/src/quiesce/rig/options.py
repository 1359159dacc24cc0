"""What a rig in the computer is made of, as options of the bench's `live`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import default_plant
from quiesce.engine.bench import setting_options

LAW = "phase"


@dataclass(frozen=True)
class RigSetup:
    """plant: the one that ships where it is None. board: where it has several dampers."""

    plant: Path | None = None
    board: Path | None = None
    law: str = LAW
    settings: Sequence[str] = ()  # NAME=VALUE
    tables: Sequence[tuple[str, Path]] = ()  # of the bench: ("rules", file)

    def words(self) -> list[str]:
        """UsageError where a file is not there."""
        plant = self.plant or default_plant()
        files = [("plant", plant), *self.tables]
        if self.board is not None:
            files.append(("board", self.board))
        words = ["--law", self.law, *setting_options(self.settings)]
        for option, file in files:
            if not file.is_file():
                raise UsageError(f"{file}: there is no such file")
            words += [f"--{option}", str(file)]
        return words
