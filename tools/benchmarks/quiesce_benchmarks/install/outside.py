"""The projects of examples/embed: built out of the tree, and run."""

import shutil
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.paths import root

EXAMPLES = "examples/embed"
M4_RUN = (
    "qemu-system-arm -M mps2-an386 -display none -monitor none -serial none "
    "-semihosting-config enable=on,target=native -kernel"
).split()
TIMEOUT_s = 600


def run(*command: str | Path, folder: Path | None = None, timeout_s: float = TIMEOUT_s) -> str:
    """What it printed. BenchFailure with its complaint or where it takes too long, UsageError where
    the tool is absent."""
    words = [str(word) for word in command]
    if shutil.which(words[0]) is None and not Path(words[0]).is_file():
        raise UsageError(f"{words[0]} is not installed; ./tools/setup test installs it")
    try:
        ended = subprocess.run(
            words,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=timeout_s,
        )
    except subprocess.TimeoutExpired:
        raise BenchFailure(f"{' '.join(words[:3])} takes more than {timeout_s:g} s") from None
    if ended.returncode != 0:
        said = "\n".join(
            line for line in (ended.stderr + ended.stdout).splitlines() if "rror" in line
        )
        raise BenchFailure(
            f"{' '.join(words[:3])} ended with {ended.returncode}: "
            f"{one_line(said or ended.stderr or ended.stdout)}"
        )
    return ended.stdout


def build(source: Path, folder: Path, **options: str | Path) -> Path:
    """Configures and builds a CMake project; its folder."""
    given = [f"-D{name}={value}" for name, value in options.items()]
    run("cmake", "-G", "Ninja", "-S", source, "-B", folder, *given)
    run("cmake", "--build", folder)
    return folder


def install(folder: Path) -> Path:
    """The library alone, built and installed; the prefix."""
    prefix = folder / "installed"
    made = build(root(), folder / "library", QUIESCE_DEVELOP="OFF", CMAKE_INSTALL_PREFIX=prefix)
    run("cmake", "--install", made)
    return prefix


def _example(name: str) -> Path:
    return root() / EXAMPLES / name


def _add_subdirectory(folder: Path) -> str:
    return run(build(_example("add_subdirectory"), folder, QUIESCE_DIR=root()) / "app")


def _fetch_content(folder: Path) -> str:
    commit = run("git", "-C", root(), "rev-parse", "HEAD").strip()
    made = build(_example("fetch_content"), folder, QUIESCE_URL=root(), QUIESCE_TAG=commit)
    return run(made / "app")


def _find_package(folder: Path) -> str:
    made = build(_example("find_package"), folder / "app", CMAKE_PREFIX_PATH=install(folder))
    return run(made / "app")


def _plain(folder: Path) -> str:
    """As one would have it: a folder beside the sources, with two files of the example."""
    project = folder / "project"
    project.mkdir()
    shutil.copy(_example("app.c"), folder)
    shutil.copy(_example("plain/Makefile"), project)
    run("make", f"QUIESCE_DIR={root()}", folder=project)
    return run(project / "app")


def _cpp(folder: Path) -> str:
    return run(build(_example("cpp"), folder / "app", CMAKE_PREFIX_PATH=install(folder)) / "app")


def build_image(folder: Path, **choice: str) -> Path:
    """The image of examples/embed/cortex_m4 with these values of its options."""
    source = _example("cortex_m4")
    made = build(
        source,
        folder,
        QUIESCE_DIR=root(),
        CMAKE_TOOLCHAIN_FILE=source / "toolchain.cmake",
        CMAKE_BUILD_TYPE="MinSizeRel",
        **choice,
    )
    return made / "app"


def _cortex_m4(folder: Path) -> str:
    return run(*M4_RUN, build_image(folder))


# Each builds its project in an empty folder, runs what came out and returns what that printed;
# BenchFailure where one of them fails.
PROJECTS: Mapping[str, Callable[[Path], str]] = {
    "add_subdirectory": _add_subdirectory,
    "fetch_content": _fetch_content,
    "find_package": _find_package,
    "plain": _plain,
    "cpp": _cpp,
    "cortex_m4": _cortex_m4,
}
