"""Compiles the image of a board, by CMake, out of a checkout of the project."""

import os
import re
import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError, one_line
from quiesce.base.nearest import meant
from quiesce.base.paths import build_folder, is_installed, root, shown
from quiesce.table.file import SUFFIX, read_file

PRESET = "stm32f4"
SLOTS = 2
BOARDS_FILE = "targets/stm32f4/boards.cmake"
Say = Callable[[str], None]
STEP = re.compile(r"\[(\d+)/(\d+)\]")


def boards() -> list[str]:
    """Names of the boards with an image. UsageError where this is no checkout."""
    if is_installed():
        raise UsageError(
            "images are compiled out of a checkout of the project, which this package is not; "
            "`quiesce firmware info`, `verify` and `flash` work here"
        )
    text = (root() / BOARDS_FILE).read_text(encoding="utf-8")
    return re.findall(r"^quiesce_stm32f4_board\((\w+)", text, re.MULTILINE)


def require_board(name: str) -> None:
    known = boards()
    if name not in known:
        near = meant(name, known)
        raise UsageError(f"no board '{name}'; there are {', '.join(known)}{near}")


@dataclass(frozen=True)
class Made:
    """ELF files: the image by itself, boot code, and the image for each of two places."""

    whole: Path
    boot: Path
    slots: tuple[Path, ...]

    @classmethod
    def of(cls, whole: Path) -> "Made":
        """As CMake names them."""
        boot, *slots = (
            whole.with_stem(whole.stem + part)
            for part in ("_boot", *(f"_slot{i}" for i in range(SLOTS)))
        )
        return cls(whole, boot, tuple(slots))

    def targets(self) -> list[str]:
        return [file.stem for file in (self.whole, self.boot, *self.slots)]


def make(board: str, tables: Sequence[Path], say: Say) -> Made:
    """tables: linked in, in the place of those that ship. say: is told how far it is. UsageError
    where something is missing, with what the compiler said last."""
    require_board(board)
    for table in tables:
        if table.suffix != SUFFIX:
            raise UsageError(f"{shown(table)}: no table file; its name ends in {SUFFIX}")
        read_file(table)
    for tool in ("cmake", "ninja", "arm-none-eabi-gcc"):
        if shutil.which(tool) is None:
            raise UsageError(f"{tool} is not installed; run ./tools/setup")
    folder = build_folder() / "firmware" / "cmake"
    linked = ";".join(str(table.resolve()) for table in tables)
    configure = ["cmake", "--preset", PRESET, "-B", str(folder), f"-DQUIESCE_TABLES={linked}"]
    run(configure, "configuring", say)
    made = Made.of(folder / "targets/stm32f4" / f"quiesce_stm32f4_{board}.elf")
    build = ["cmake", "--build", str(folder), "--target", *made.targets()]
    run(build, f"compiling {board}", say)
    return made


def run(command: Sequence[str], what: str, say: Say) -> None:
    environment = {**os.environ}
    if shutil.which("ccache"):
        environment |= {"CMAKE_C_COMPILER_LAUNCHER": "ccache", "CCACHE_BASEDIR": str(root())}
    process = subprocess.Popen(
        command, cwd=root(), env=environment, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )  # fmt: skip
    assert process.stdout is not None
    lines: list[str] = []
    for line in process.stdout:
        lines.append(line.rstrip())
        step = STEP.match(line)
        if step:
            say(f"{what}: {step[1]} of {step[2]}")
    if process.wait() != 0:
        said = [line for line in lines if "error" in line.lower()] or lines[-1:]
        raise UsageError(f"{what} failed: {one_line(said[0] if said else 'nothing was said')}")


def compiler_version() -> str:
    """Of the cross compiler, `arm-none-eabi-gcc 12.2.1`."""
    done = subprocess.run(
        ["arm-none-eabi-gcc", "-dumpfullversion"], capture_output=True, text=True, check=True
    )
    return done.stdout.strip()
