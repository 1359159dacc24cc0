"""Files that the texts of a TOML file name, by their paths from its folder."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any


def whole(value: Any, folder: Path) -> Any:
    """A copy in which each text that names a file from this folder is its whole path."""
    if isinstance(value, dict):
        return {key: whole(item, folder) for key, item in value.items()}
    if isinstance(value, list):
        return [whole(item, folder) for item in value]
    if isinstance(value, str) and is_file(folder / value):
        return str((folder / value).resolve())
    return value


def is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a text that no path can be
        return False


def files_in(value: Any) -> Iterator[Path]:
    """Files that texts in it name by their whole paths."""
    if isinstance(value, dict | list):
        for item in value.values() if isinstance(value, dict) else value:
            yield from files_in(item)
    elif isinstance(value, str) and value.startswith("/") and is_file(Path(value)):
        yield Path(value)
