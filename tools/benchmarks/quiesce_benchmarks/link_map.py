"""Which source file an address of an image comes from, as GNU ld's map file says."""

import re
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown

# " .text.rms_step", then, on the same line or the next, "0xADDRESS 0xSIZE FILE"; FILE is an object
# or archive(member). A section that was thrown away stands at address 0 without a place in memory.
SECTION = re.compile(
    r"^ \.text[^\s]*\s+0x(?P<address>[0-9a-f]+)\s+0x(?P<size>[0-9a-f]+)\s+(?P<file>\S.*)$", re.M
)
PLACED = "Linker script and memory map"


@dataclass(frozen=True)
class Section:
    begin: int
    end: int
    source: str  # name of the source file without its ending; "libgcc" for the compiler's own


def source_of(file: str) -> str:
    """lib.a(rms.c.obj) -> rms; path/main.c.obj -> main; .../libgcc.a(_udivmoddi4.o) -> libgcc."""
    archive, _, member = file.rstrip(")").partition("(")
    if Path(archive).name in ("libgcc.a", "libc.a"):
        return Path(archive).stem
    return Path(member or archive).name.split(".")[0]


def read_sections(file: Path) -> list[Section]:
    """Code sections of the image, by address."""
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; rebuild the image")
    placed = text.partition(PLACED)[2]
    found = []
    for match in SECTION.finditer(placed):
        begin, size = int(match["address"], 16), int(match["size"], 16)
        if size:
            found.append(Section(begin, begin + size, source_of(match["file"])))
    if not found:
        raise UsageError(f"{shown(file)}: no code sections in it; rebuild the image")
    return sorted(found, key=lambda section: section.begin)


def by_source(sections: list[Section], executed: Mapping[int, int]) -> dict[str, int]:
    """Sums what was executed at each address by source file, the largest first."""
    begins = [section.begin for section in sections]
    sums: dict[str, int] = {}
    for address, count in executed.items():
        index = bisect_right(begins, address) - 1
        is_inside = index >= 0 and address < sections[index].end
        source = sections[index].source if is_inside else "unknown"
        sums[source] = sums.get(source, 0) + count
    return dict(sorted(sums.items(), key=lambda item: -item[1]))
