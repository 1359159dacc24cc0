"""Parameters by name and index, as firmware/param/parameters.toml has them."""

import zlib
from collections.abc import Sequence
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.engine.params import expected, parameters, parse_value


def name_of(index: int) -> str:
    known = parameters()
    return known[index]["name"] if index < len(known) else f"parameter {index}"


def text_of(parameter: dict[str, Any], value: int) -> str:
    """A value as a user writes it: its label where it has one."""
    labels = parameter["labels"] or []
    return labels[value] if 0 <= value < len(labels) else str(value)


def settings_of(words: Sequence[str]) -> dict[int, int]:
    """NAME=VALUE words as values by index. UsageError where one is not allowed."""
    known = {one["name"]: one for one in parameters()}
    settings: dict[int, int] = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals:
            raise UsageError(f"{word}: write NAME=VALUE")
        if name not in known:
            raise UsageError(f"{word}: no parameter '{name}'; 'quiesce can get' lists all")
        try:
            settings[known[name]["index"]] = parse_value(known[name], text)
        except UsageError:
            raise UsageError(f"{word}: {name} is {expected(known[name])}")
    return settings


def hash_of(values: Sequence[int]) -> int:
    """CRC-32 of the values as 32-bit words in index order, little-endian (Identification)."""
    return zlib.crc32(b"".join((value & 0xFFFFFFFF).to_bytes(4, "little") for value in values))
