"""The table of the rooms (rooms.toml), and which folder of a tree is none of them."""

import os
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

TABLE = Path(__file__).with_name("rooms.toml")
# What is made, not written.
MADE = ("build", "__pycache__", "node_modules")
# Rigs: data, never names in code.
RIGS = ("squeeze_2012",)


@cache
def table() -> dict:
    return tomllib.loads(TABLE.read_text(encoding="utf-8"))


@cache
def listed_folders() -> tuple[str, ...]:
    groups = [*table()["questions"], table()["beside"]]
    return tuple(folder for group in groups for folder in group["folders"])


def is_made(name: str) -> bool:
    return name.startswith(".") or name in MADE or name.endswith(".egg-info")


def folders(root: Path) -> Iterator[tuple[str, list[str], list[str]]]:
    """Every folder that is written by hand, from the root: its path, folders and files."""
    for path, inside, files in os.walk(root):
        inside[:] = sorted(name for name in inside if not is_made(name))
        relative = os.path.relpath(path, root)
        yield "" if relative == "." else relative, inside, sorted(files)


def unknown_rooms(root: Path) -> Iterator[str]:
    """Folders to which none of the nine questions leads; the uppermost of each."""
    for folder, inside, _ in folders(root):
        known = []
        for name in inside:
            path = os.path.join(folder, name)
            if path in listed_folders():
                continue
            if any(one.startswith(f"{path}/") for one in listed_folders()):
                known.append(name)
            else:
                yield f"{path}/ is no room: no question of rooms.toml leads there"
        inside[:] = known


def stale_rooms(root: Path) -> Iterator[str]:
    """What the table lists and the tree does not have."""
    optional = ("docs/tutorial",)
    for folder in listed_folders():
        if folder not in optional and not (root / folder).is_dir():
            yield f"rooms.toml lists {folder}, which is not there"
