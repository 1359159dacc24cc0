"""A table that a viewer has on his computer, on its way into the controller: the road of
`quiesce can load`, with its checks."""

import base64
import binascii
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError, one_line
from quiesce.can.roads import LEARNT
from quiesce.can.services import Services
from quiesce.can.tables import Tables
from quiesce.loading.load import put
from quiesce.loading.sources import WORDS, Table, table_of

KEYS = {"kind", "name", "part", "parts", "data"}
KINDS = tuple(one for one in WORDS if one != LEARNT)
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
PART_BYTES = 2700  # 3600 letters: a message holds no more
MOST_PARTS = 64


@dataclass(frozen=True)
class TablePart:
    """One message's share of a file: part 0 .. parts - 1."""

    kind: str
    name: str
    part: int
    parts: int
    data: bytes


def table_part_of(said: dict[str, object]) -> TablePart:
    """ValueError where it is none."""
    kind, name, part, parts = (said[key] for key in ("kind", "name", "part", "parts"))
    if kind not in KINDS:
        raise ValueError(f"'kind' is one of {', '.join(KINDS)}")
    if not isinstance(name, str) or NAME.fullmatch(name) is None:
        raise ValueError("'name' is that of a file: at most 64 letters, digits, '.', '_', '-'")
    is_counted = type(part) is int and type(parts) is int
    if not is_counted or not 0 <= part < parts <= MOST_PARTS:  # type: ignore[operator]
        raise ValueError(f"a file comes in 1 .. {MOST_PARTS} parts, counted from 0")
    try:
        data = base64.b64decode(said["data"], validate=True)  # type: ignore[arg-type]
    except (TypeError, ValueError, binascii.Error):
        raise ValueError("'data' is base64")
    if len(data) > PART_BYTES:
        raise ValueError(f"a part has at most {PART_BYTES} bytes")
    return TablePart(str(kind), name, part, parts, data)  # type: ignore[arg-type]


class Upload:
    """Of one viewer: parts in their order become a file."""

    def __init__(self) -> None:
        self._parts: list[TablePart] = []

    def take(self, one: TablePart) -> bytes | None:
        """The whole file with its last part. UsageError where a part is not the next one of the
        same file: then nothing of it is kept."""
        if one.part == 0:
            self._parts = []
        first = self._parts[0] if self._parts else one
        is_next = one.part == len(self._parts)
        if not is_next or (one.kind, one.name, one.parts) != (first.kind, first.name, first.parts):
            self._parts = []
            raise UsageError("parts of a table that do not follow each other; load it again")
        self._parts.append(one)
        if len(self._parts) < one.parts:
            return None
        parts, self._parts = self._parts, []
        return b"".join(part.data for part in parts)


def use(kind: str, name: str, data: bytes) -> Callable[[Services], str]:
    """What the job does: made a table, sent, checked by the controller, in use. UsageError where it
    is none, BenchFailure where the controller refuses it: nothing was changed."""

    def work(services: Services) -> str:
        table = made(kind, name, data)
        put(Tables(services.link, services.requests.database), table, lambda _: None)
        used = f"{table.kind.name} {table.crc:08x} is in use; the next start has what it had"
        return "; ".join([f"{name}: {used}", *table.notes])

    return work


def made(kind: str, name: str, data: bytes) -> Table:
    """UsageError, in one line, where it is none, or this computer has no room for it."""
    try:
        with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
            file = Path(folder) / name
            file.write_bytes(data)
            try:
                return table_of(kind, file)
            except UsageError as error:
                raise UsageError(str(error).replace(f"{folder}/", ""))
    except OSError as error:
        raise UsageError(f"{name}: {one_line(error)}")
