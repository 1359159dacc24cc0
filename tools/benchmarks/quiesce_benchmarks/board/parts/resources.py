"""Bytes of code and constants of every law and block, on every processor, beside the recorded."""

import json
import re
import subprocess
from pathlib import Path

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder, root
from quiesce.base.table import format_table
from quiesce.engine.bench import require_file

from quiesce_benchmarks.part import Effort, Measured

TITLE = "resources: bytes of every law on every processor"
FIGURES = (
    ("resource_growth_pct", "%", 3.0, "lower"),
    ("resource_cells", "cells", None, "higher"),
)
# The build's preset and the compiler's prefix. All of them -O3, one sensor, one damper.
PORTS = {
    "m0plus": "arm-none-eabi-",
    "m3": "arm-none-eabi-",
    "m4f": "arm-none-eabi-",
    "m7": "arm-none-eabi-",
    "m33": "arm-none-eabi-",
    "rv32": "riscv64-unknown-elf-",
    "aarch64": "aarch64-linux-gnu-",
}
LIBRARY = "firmware/libquiesce_core_1x1.a"
COMMITTED = "docs/results/board.json"
# "   text   data   bss   dec   hex   law_off.c.obj (ex .../lib.a)"
MEMBER = re.compile(r"^\s*(\d+)\s+(\d+)\s+\d+\s+\d+\s+[0-9a-f]+\s+(\S+?)\.c\.o(?:bj)? ", re.M)
TOTAL = "all"


def group_of(source: Path) -> str:
    """`law fuzzy` of law/law_fuzzy.c, `law/phase` of what that folder shares, else the block."""
    parts = source.relative_to(root() / "firmware").parts
    if source.stem.startswith("law_"):
        return f"law {source.stem.removeprefix('law_')}"
    return "/".join(parts[:-1]) if parts[0] == "law" else parts[0]


def groups() -> dict[str, str]:
    """By the name of a source file, which is one in the whole of the firmware."""
    files = sorted((root() / "firmware").rglob("*.c"))
    return {file.stem: group_of(file) for file in files}


def sizes_of(listing: str, names: dict[str, str]) -> dict[str, int]:
    """Bytes in flash by group, of what `size` prints for a library."""
    sums: dict[str, int] = {}
    for text, data, stem in MEMBER.findall(listing):
        for group in (names.get(stem, "other"), TOTAL):
            sums[group] = sums.get(group, 0) + int(text) + int(data)
    return dict(sorted(sums.items()))


def measured_sizes() -> dict[str, dict[str, int]]:
    """By group, then by port."""
    table: dict[str, dict[str, int]] = {}
    names = groups()
    for port, prefix in PORTS.items():
        library = require_file(build_folder() / port / LIBRARY, "the library")
        done = subprocess.run([f"{prefix}size", library], capture_output=True, text=True)
        if done.returncode != 0:
            raise BenchFailure(f"{prefix}size: {done.stderr.strip()}")
        for group, size in sizes_of(done.stdout, names).items():
            table.setdefault(group, {})[port] = size
    return table


def growth_pct(found: dict[str, dict[str, int]], before: dict[str, dict[str, int]]) -> float | None:
    """The largest of what both have, a cell below 200 bytes as one of 200; None without any."""
    pairs = [
        (size, before[group][port])
        for group, row in found.items()
        for port, size in row.items()
        if port in before.get(group, {})
    ]
    return max((100.0 * (now - then) / max(then, 200) for now, then in pairs), default=None)


def committed_sizes() -> dict[str, dict[str, int]]:
    file = root() / COMMITTED
    if not file.is_file():
        return {}
    context = json.loads(file.read_text(encoding="utf-8"))["context"]
    sizes: dict[str, dict[str, int]] = context["reported"]["resources"].get("sizes", {})
    return sizes


def measure(effort: Effort) -> Measured:
    found = measured_sizes()
    rows = [[group, *(row.get(port, 0) for port in PORTS)] for group, row in found.items()]
    table = format_table(["bytes of flash", *PORTS], rows)
    values = {
        "resource_growth_pct": growth_pct(found, committed_sizes()),
        "resource_cells": float(sum(map(len, found.values()))),
    }
    return Measured(values, {"sizes": found}, (table,))
