"""Where files are: in a checkout, or installed as a package.

A package carries of the project's tree what it reads (plants, scenarios, dampers, the DBC, sources
to hand out) and the compiled parts in its folder `tree`, at the places that they have in a
checkout. Two environment variables override what is found: QUIESCE_ROOT (that tree) and
QUIESCE_BUILD (the folder that holds the builds host/ and mps2/).
"""

import os
from pathlib import Path

from quiesce.base.errors import UsageError

INSTALLED = Path(__file__).resolve().parents[1] / "tree"
CHECKOUT = Path(__file__).resolve().parents[4]
# What results go into where there is no checkout: in the caller's folder.
RESULTS = "quiesce-out"


def is_installed() -> bool:
    """Whether this is the package by itself, and no checkout of the project."""
    return not os.environ.get("QUIESCE_ROOT") and INSTALLED.is_dir()


def root() -> Path:
    """The project's folder, or what the package has of it."""
    named = os.environ.get("QUIESCE_ROOT")
    folder = Path(named) if named else INSTALLED if INSTALLED.is_dir() else CHECKOUT
    if not (folder / "sim_hil/data").is_dir():
        raise UsageError(
            f"{folder} is not the Quiesce project (no sim_hil/data); set QUIESCE_ROOT to its folder"
        )
    return folder


def build_folder() -> Path:
    """Compiled parts."""
    named = os.environ.get("QUIESCE_BUILD")
    return Path(named) if named else root() / "build"


def results_folder() -> Path:
    """Where commands write what nobody gave them a place for."""
    return Path(RESULTS) if is_installed() else build_folder()


def results_text(name: str) -> str:
    """That place, as a help says it."""
    return f"{RESULTS if is_installed() else 'build'}/{name}"


def cache_folder() -> Path:
    """What is computed once and kept: nothing is lost with it."""
    if not is_installed():
        return build_folder()
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "quiesce"


def how_to_build() -> str:
    """What to do where a compiled part is missing."""
    if is_installed():
        return "it is no part of this package: use a checkout of the project"
    return "run ./tools/hil first"


def typed(command: str) -> str:
    """`quiesce ...` as it is typed here: in a checkout its scripts stand before it."""
    if is_installed():
        return command
    script = command.removeprefix("quiesce ") if command.startswith("quiesce hil") else command
    return f"./tools/{script}"


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
