"""Runs of the node in images of its own (tools/benchmarks/mps2/tables): tick by tick, whatever else
this machine does."""

import struct
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.engine.bench import Bench
from quiesce.engine.params import parameters, parse_value
from quiesce.table.words import packed

from quiesce_benchmarks.images import built_image
from quiesce_benchmarks.tables.samples import Sample


def param_words(settings: Mapping[str, str]) -> list[int]:
    """All parameters, in the order of their indices."""
    return [
        parse_value(one, settings[one["name"]]) if one["name"] in settings
        else parse_value(one, default_text(one))
        for one in parameters()
    ]  # fmt: skip


def default_text(param: Mapping[str, Any]) -> str:
    return str(param["labels"][param["default"]] if param["labels"] else param["default"])


def order(
    part: int, ticks: int, sample: Sample, words: Sequence[int], settings: Mapping[str, str]
) -> bytes:
    """rig_order_t: a sample's first table, what it needs, and the table that is to come."""
    # The law's table comes before its tracker's, and both before one of the kind itself.
    first = sample.first[0]
    others = [] if sample.before is None else [sample.before]
    found = [first, *others] if sample.road == "law" else [*others, first]
    params = param_words({**settings, **sample.settings})
    head = struct.pack(f"<3I{len(params)}i", part, ticks, len(found) + 1, *params)
    return head + b"".join(packed(one) for one in (*found, words))


def run_image(image: str, data: bytes) -> dict[str, Any]:
    """What it counted and printed. BenchFailure where a table of the order is not taken."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "order"
        file.write_bytes(data)
        found = Bench().json("count", "--image", str(built_image(image)), "--data", str(file))
    if found["printed"]["refused"]:
        raise BenchFailure(f"{image}: the tables of the start were not taken: {found['printed']}")
    return dict(found)
