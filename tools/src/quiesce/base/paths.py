"""Where the project's files are.

Two environment variables override what is found: QUIESCE_ROOT (the project's folder) and
QUIESCE_BUILD (the folder that holds the builds host/ and mps2/).
"""

import os
from pathlib import Path

from quiesce.base.errors import UsageError


def root() -> Path:
    """The project's folder. The package lies in its tools/src."""
    named = os.environ.get("QUIESCE_ROOT")
    folder = Path(named) if named else Path(__file__).resolve().parents[4]
    if not (folder / "CMakePresets.json").is_file():
        raise UsageError(
            f"{folder} is not the Quiesce project (no CMakePresets.json); "
            "set QUIESCE_ROOT to its folder"
        )
    return folder


def build_folder() -> Path:
    named = os.environ.get("QUIESCE_BUILD")
    return Path(named) if named else root() / "build"


def measurements(kind: str) -> Path:
    """Folder of the recordings of one kind ("vibration", "earthquake", "mr_damper"), which lie
    beside the project; it may not be there."""
    return root().parent / "shared/data" / kind


def default_plant() -> Path:
    """The rig that ships: the one place of the package that names it."""
    return root() / "sim_hil/data/plants/squeeze_2012.toml"


def scenario_folder() -> Path:
    return root() / "sim_hil/data/scenarios"


def shown(path: Path) -> str:
    """A path as short as it can be told: relative to the caller's folder where it is inside."""
    try:
        return str(path.resolve().relative_to(Path.cwd().resolve()))
    except ValueError:
        return str(path)
