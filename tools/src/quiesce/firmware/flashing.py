"""How an image gets onto its board: one way a line. Untested on hardware."""

import shlex
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from quiesce.firmware.image import Image


@dataclass(frozen=True)
class Way:
    """command(file, address): file is the bare bytes."""

    tool: str
    what: str
    command: Callable[[Path, int], list[str]]


WAYS = {
    one.tool: one
    for one in (
        Way("openocd", "by an ST-LINK (on a Nucleo board: its USB)", lambda file, at: [
            "openocd", "-f", "interface/stlink.cfg", "-f", "target/stm32f4x.cfg",
            "-c", f"program {{{file}}} verify reset exit 0x{at:08X}",
        ]),
        Way("pyocd", "by any CMSIS-DAP or ST-LINK probe", lambda file, at: [
            "pyocd", "load", "--target", "stm32f4", "--base-address", f"0x{at:08X}",
            "--format", "bin", str(file),
        ]),
        Way("dfu-util", "by the chip's own loader over USB (BOOT0 high)", lambda file, at: [
            "dfu-util", "-d", "0483:df11", "-a", "0", "-s", f"0x{at:08X}:leave", "-D", str(file),
        ]),
    )
}  # fmt: skip


def flash_page(name: str, image: Image) -> str:
    """For the folder of a build."""
    file = Path(f"{name}.bin")
    ways = [f"{one.what}:\n\n    {line(one.command(file, image.begin))}\n" for one in WAYS.values()]
    return "\n".join(
        [
            f"# {name} onto {image.board}",
            "",
            "No coil, or its supply off, until the board has started. `quiesce firmware verify .`",
            "first; then one of",
            "",
            *ways,
            "or `quiesce firmware flash . --with TOOL`, which verifies first.",
            "",
            f"For updates over the bus flash `{name}.updatable.bin` instead, once, in the same",
            "ways (`--updatable`); later ones come by `quiesce can update FOLDER`.",
            "",
        ]
    )


def line(words: list[str]) -> str:
    """As a shell takes it."""
    return shlex.join(words)
