"""TOML files that name each other, and values in them by their path.

A path goes through tables by key, through arrays by number or by the `name` of an element, and on
into the file that a value names: `plant.damper.file.parameters.f0_N` is in the plant's damper file.
"""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.named_files import files_in, whole
from quiesce.base.paths import shown

Change = Callable[[Any], Any]


class Sheet(dict[str, Any]):
    """A file's content that differs from the file: it is written anew for a run."""


class Documents(dict[str, Any]):
    """TOML files by their whole paths, files that they name by their whole paths in them."""

    def add(self, file: Path) -> None:
        """The file, and all that it names. UsageError where it is no TOML file."""
        if str(file) in self:
            return
        try:
            data = tomllib.loads(file.read_text(encoding="utf-8"))
        except OSError as error:
            raise UsageError(f"{shown(file)}: {error.strerror}")
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise UsageError(f"{shown(file)}: not a TOML file: {one_line(error)}")
        self[str(file)] = data = whole(data, file.parent)
        for named in files_in(data):
            if named.suffix == ".toml":
                self.add(named)


def with_change(
    node: Any, path: Sequence[str], change: Change, documents: Mapping[str, Any], seen: str = ""
) -> Any:
    """A copy of node, of which all that is not changed stays shared, with change(value) at path.

    UsageError where the path leads nowhere; its last key may be a new one of a table.
    """
    if not path:
        return change(node)
    if isinstance(node, str) and node in documents:
        node = Sheet(documents[node])
    head, rest = path[0], path[1:]
    here = f"{seen}.{head}".lstrip(".")
    if isinstance(node, dict):
        if rest and head not in node:
            raise UsageError(f"{here}: there is no such key; there are: {', '.join(node)}")
        inner = with_change(node.get(head), rest, change, documents, here)
        return type(node)({**node, head: inner})
    if isinstance(node, list):
        at = _index(node, head, here)
        inner = with_change(node[at], rest, change, documents, here)
        return [*node[:at], inner, *node[at + 1 :]]
    raise UsageError(f"{here}: {seen} is neither a table nor a file of tables")


def _index(items: list[Any], head: str, here: str) -> int:
    names = [item.get("name") if isinstance(item, dict) else None for item in items]
    if head in names:
        return names.index(head)
    if head.isascii() and head.isdigit() and int(head) < len(items):
        return int(head)
    known = [str(name) for name in names if name is not None]
    also = f", or one of: {', '.join(known)}" if known else ""
    raise UsageError(f"{here}: expected a number below {len(items)}{also}")
