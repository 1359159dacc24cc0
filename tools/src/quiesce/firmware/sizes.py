"""What an image takes of flash and memory: of its ELF file's sections and symbols."""

from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from quiesce.base.extras import extra
from quiesce.base.table import format_table
from quiesce.firmware.image import read_bytes

FLAG_ALLOCATED = 0x2
STACK, NO_BITS = ".stack", "SHT_NOBITS"
LARGEST = 15


@dataclass(frozen=True)
class Sizes:
    """Bytes. largest: name and size of symbols, of both memories together."""

    flash: int
    ram: int
    stack: int
    sections: tuple[tuple[str, int, int], ...]  # name, address, size
    largest: tuple[tuple[str, int], ...]

    def text(self) -> str:
        rows = [[name, f"0x{at:08X}", f"{size:,}"] for name, at, size in self.sections]
        symbols = [[name, f"{size:,}"] for name, size in self.largest]
        return "\n".join(
            [
                f"flash {self.flash:,} bytes, RAM {self.ram:,} bytes, {self.stack:,} of them for "
                "the stack",
                "How much of the stack was ever used a running controller tells: `quiesce can "
                "monitor`.",
                "",
                format_table(["section", "at", "bytes"], rows),
                format_table(["largest objects", "bytes"], symbols),
            ]
        )


def sizes_of(elf: Path) -> Sizes:
    with extra("firmware", "an ELF file"):
        from elftools.elf.elffile import ELFFile
    file = ELFFile(BytesIO(read_bytes(elf)))
    flash = ram = stack = 0
    sections = []
    for one in file.iter_sections():
        size = one["sh_size"]
        if not one["sh_flags"] & FLAG_ALLOCATED or size == 0:
            continue
        sections.append((one.name, one["sh_addr"], size))
        is_in_ram = one["sh_type"] == NO_BITS or one.name == ".data"
        flash += 0 if one["sh_type"] == NO_BITS else size
        ram += size if is_in_ram else 0
        stack += size if one.name == STACK else 0
    table = file.get_section_by_name(".symtab")
    symbols = [] if table is None else [(one.name, one["st_size"]) for one in table.iter_symbols()]
    largest = sorted({one for one in symbols if one[0]}, key=lambda one: (-one[1], one[0]))
    return Sizes(flash, ram, stack, tuple(sections), tuple(largest[:LARGEST]))
