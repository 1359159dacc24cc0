"""The methods by name, and their files (schema quiesce-inverse-damper).

A method is a module with NAME, TITLE, HELP, TRACKER (what the controller can do with it) and
make(source, seed, progress), and its place in METHODS; one whose file is TOML has read(keys,
max_current_A, where), too. The file of the others, a map's and a bank's among them, is the table
that the controller loads: to_bytes of the inverse.
"""

import json
import tomllib
import zlib
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import tomli_w

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.damper.inverses import (
    banked,
    feed_forward,
    fuzzy,
    mapped,
    network,
    networks,
    recurrent,
    steps,
    svr,
)
from quiesce.damper.inverses.banked import BankInverse
from quiesce.damper.inverses.demand import Inverse
from quiesce.damper.inverses.keys import number
from quiesce.damper.inverses.mapped import MapInverse
from quiesce.damper.inverses.networks import NetworkInverse
from quiesce.law.forms.network import TRACK_MAGIC
from quiesce.table.file import SUFFIX, read_words

SCHEMA = "quiesce-inverse-damper"
VERSION = 2
METHODS: dict[str, ModuleType] = {
    one.NAME: one for one in (mapped, steps, feed_forward, recurrent, fuzzy, network, svr, banked)
}


def methods_of(text: str) -> list[str]:
    """Names with commas, or all. UsageError for one that there is not."""
    names = list(METHODS) if text == "all" else list(dict.fromkeys(text.split(",")))
    for name in names:
        if name not in METHODS:
            raise UsageError(f"--method '{name}': there are {', '.join(METHODS)} and all")
    return names


def is_table(method: str) -> bool:
    """Whether its file is what the controller loads."""
    return not hasattr(METHODS[method], "read")


def file_name(method: str) -> str:
    return f"{method}{SUFFIX}" if is_table(method) else f"inverse_{method}.toml"


def check_word(table: Mapping[str, Any]) -> int:
    """CRC-32 of everything in the file but this; dates of TOML as text."""
    rest = {key: value for key, value in table.items() if key != "check"}
    return zlib.crc32(json.dumps(rest, sort_keys=True, default=str).encode())


def bytes_of(method: str, inverse: Inverse) -> bytes:
    if isinstance(inverse, MapInverse | BankInverse | NetworkInverse):
        return inverse.to_bytes()
    table: dict[str, Any] = {
        "schema": SCHEMA,
        "version": VERSION,
        "method": method,
        "max_current_A": float(inverse.max_current_A),
        "parameters": inverse.parameters(),
    }
    # As TOML gives it back: the word is of what is read.
    table = tomllib.loads(tomli_w.dumps(table))
    return tomli_w.dumps({"check": check_word(table), **table}).encode()


def write_inverse(file: Path, method: str, inverse: Inverse) -> None:
    with output_files(file.parent) as staging:
        (staging / file.name).write_bytes(bytes_of(method, inverse))


def _read_table(file: Path) -> tuple[str, Inverse]:
    magic = read_words(file)[:1]
    if magic == [TRACK_MAGIC]:
        # Its words do not say how it was fitted.
        method = svr.NAME if file.stem == svr.NAME else network.NAME
        return method, networks.read_table(file)
    one = banked if banked.is_bank(file) else mapped
    return one.NAME, one.read_table(file)


def read_inverse(file: Path) -> tuple[str, Inverse]:
    """Method and inverse. UsageError with file and key where it is wrong."""
    if file.suffix == SUFFIX:
        return _read_table(file)
    where = shown(file)
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise UsageError(f"{where}: {one_line(error)}") from None
    if table.get("schema") != SCHEMA or table.get("version") != VERSION:
        raise UsageError(f"{where}: schema: expected {SCHEMA}, version {VERSION}")
    method, keys = table.get("method"), table.get("parameters")
    known = [name for name, one in METHODS.items() if hasattr(one, "read")]
    if method not in known:
        raise UsageError(f"{where}: method: expected one of {', '.join(known)}, found {method!r}")
    if not isinstance(keys, dict):
        raise UsageError(f"{where}: parameters: expected a table [parameters]")
    inverse = METHODS[method].read(keys, number(table, "max_current_A", where), where)
    if table.get("check") != check_word(table):
        raise UsageError(f"{where}: check: the file was changed after it was written")
    return method, inverse
