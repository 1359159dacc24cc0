"""examples/port as its guide has it: in a fresh folder, built, and run on the emulated board."""

import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT

PORT = ROOT / "examples/port"
# What a board has to write: all but the loop.
BACKEND = ("backend.c", "backend.h", "start.c", "memory.ld")
MOST_LINES = 200
QEMU = (
    "qemu-system-arm -M netduinoplus2 -icount shift=6 -display none -monitor none -serial none "
    "-semihosting-config enable=on,target=native -kernel"
).split()
NOT_FOUND = 2  # main.c


def built(folder: Path) -> Path:
    subprocess.run(["cmake", "--build", "build"], cwd=folder, check=True, capture_output=True)
    return folder / "build/port"


def exit_code(image: Path) -> int:
    return subprocess.run([*QEMU, image], stdin=subprocess.DEVNULL, timeout=600).returncode


def test_a_backend_is_small() -> None:
    lines = sum(len((PORT / name).read_text().splitlines()) for name in BACKEND)
    assert lines < MOST_LINES


def test_the_guide_runs_what_the_test_runs() -> None:
    guide = (ROOT / "docs/howto/port-to-your-board.md").read_text()
    assert " ".join(QEMU) in " ".join(guide.replace("\\\n", " ").split())
    for file in PORT.iterdir():
        assert file.name == "CMakeLists.txt" or f"`{file.name}`" in guide or file.suffix == ".h"


@pytest.mark.slow
def test_a_copy_builds_finds_the_vibration_and_notices_another(tmp_path: Path) -> None:
    folder = tmp_path / "my_board"
    shutil.copytree(PORT, folder)
    options = {
        "CMAKE_TOOLCHAIN_FILE": folder / "toolchain.cmake",
        "CMAKE_BUILD_TYPE": "MinSizeRel",
        "QUIESCE_DIR": ROOT,
    }
    given = [f"-D{name}={value}" for name, value in options.items()]
    configure = ["cmake", "-G", "Ninja", "-B", "build", *given]
    subprocess.run(configure, cwd=folder, check=True, capture_output=True)
    assert exit_code(built(folder)) == 0

    backend = folder / "backend.c"
    text = backend.read_text()
    assert text.count("100u;") == 1
    backend.write_text(text.replace("100u;", "80u;"))  # not 10 Hz any more
    assert exit_code(built(folder)) == NOT_FOUND
