"""What a change touches: which tests, gates and sources look at the files that it names.

touched.py edit  reads paths; prints what ./tools/test edit runs, a line each: "format FILE", "ruff
                 FILE", "script FILE", "generated", "board", "pytest PATH", and "unit FOLDER TARGETS
                 REGEX" for tests of a folder of tests/, with the build's targets by commas
touched.py tidy  reads "LINES PATH"; prints the sources for clang-tidy, most changed first
touched.py area  reads "LINES PATH"; prints the folder of tests/unit whose subject changed most
"""

import re
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# First match: where a file's own C and C++ tests are; (): in the folder that its path names.
AREAS = (
    ("tests/unit/", ()),
    ("firmware/comm/", ("comm",)),
    ("firmware/", ("firmware",)),
    ("hal/linux/", ("linux",)),
    ("hal/image/", ("hal",)),
    ("hal/records/", ("hal",)),
    ("hal/parts/", ("linux", "stm32f4")),
    ("hal/cortex_m/", ("stm32f4",)),
    ("hal/stm32f4/", ("stm32f4",)),
    ("targets/stm32f4/", ("stm32f4",)),
    ("targets/linux/", ("linux",)),
    ("targets/lockstep/", ("comm",)),
    ("sim_hil/board/", ("board",)),
    ("sim_hil/plant/", ("plant",)),
    ("sim_hil/damper/", ("plant",)),
    ("sim_hil/link/", ("link",)),
    ("sim_hil/python/", ("plant",)),
    ("sim_hil/", ("bench",)),
)
# Their sanitized builds are minutes of templates; `all` has them.
HEAVY_AREAS = ("plant", "bench", "link")
BOARD = (
    "hal/image/",
    "hal/cortex_m/",
    "hal/mps2/",
    "targets/mps2/",
    "targets/node/",
    "tests/unit/mps2/",
)
# Python packages whose tests are not in the folder of their name.
PYTHON_TESTS = {
    "base": ("gates/test_bad_input.py",),
    "cli": ("gates/test_bad_input.py",),
    "engine": ("hil/test_hil.py",),
    "optimum": ("tune/test_control_bound.py",),
    "plant": ("plant", "damper/test_plant_dampers.py"),
    "report": ("report", "damper/test_damper_report.py"),
}
SCRIPTS = (
    ".ci/",
    "tools/check/",
    "tools/hil",
    "tools/lib/",
    "tools/quiesce",
    "tools/setup",
    "tools/test",
)
SCRIPT_TESTS = tuple(
    f"gates/test_{name}.py"
    for name in ("setup_scripts", "gates", "start_without_build", "tiers", "touched")
)
PAGE_TESTS = ("docs/test_pages.py", "docs/test_results.py")
GENERATED = re.compile(r"(generated/|\.(toml|dbc|fcl)$|/gen/.*\.py$)")
SOURCE = re.compile(r"\.(c|h|cpp|hpp)$")
TIDY = re.compile(r"^(firmware|hal|targets|sim_hil)/(?!.*generated/).*\.(c|cpp)$")
MOST_TIDY = 24  # files: some minutes of two processors


def areas_of(path: str) -> tuple[str, ...]:
    for start, areas in AREAS:
        if path.startswith(start):
            return areas or (path.split("/")[2],)
    return ()


def includes(source: Path, headers: set[str]) -> bool:
    text = source.read_text(encoding="utf-8")
    return any(name in headers for name in re.findall(r'#include "([^"]+)"', text))


def unit_tests_of(path: str) -> list[str]:
    """Names of the tests in C that see the folder of a file of the firmware; a test's own."""
    file = Path(path)
    if file.name.startswith("test_"):
        return [file.stem]
    headers = {header.name for header in (ROOT / file).parent.glob("*.h")}
    tests = (ROOT / "tests/unit/firmware").glob("test_*.c")
    return sorted(test.stem for test in tests if includes(test, headers))


def units(paths: list[str]) -> list[str]:
    """The lines of kind `unit`."""
    lines = []
    areas = {area for path in paths if SOURCE.search(path) for area in areas_of(path)}
    names = {
        test
        for path in paths
        if SOURCE.search(path) and "firmware" in areas_of(path)
        for test in unit_tests_of(path)
    }
    is_firmware = any(path.startswith("firmware/") and SOURCE.search(path) for path in paths)
    if is_firmware:
        names.add("test_controller")
    if is_firmware or any(path.startswith("tests/golden/") for path in paths):
        lines.append("unit golden golden_streams .")
    for area in sorted(areas - {"mps2", "support"}):
        if area == "firmware" and names:
            chosen = sorted(names)
            lines.append(f"unit unit/firmware {','.join(chosen)} ^({'|'.join(chosen)})$")
        else:
            lines.append(f"unit unit/{area} tests/unit/{area}/all .")
    return lines


def python_tests(path: str) -> list[str]:
    """Tests of a Python file: itself, or those of its package. Tests of a page or an example."""
    if re.match(r"tests/python/.*/?test_\w+\.py$", path):
        return [path]
    parts = path.split("/")
    if path.startswith("tools/src/quiesce/") and len(parts) > 4:
        names: Iterable[str] = PYTHON_TESTS.get(parts[3], (parts[3],))
    elif path.startswith("tools/benchmarks/quiesce_benchmarks/"):
        names = PAGE_TESTS if "/house/" in path else ("benchmarks",)
    elif path.startswith(SCRIPTS):
        names = SCRIPT_TESTS
    elif path.startswith("tests/python/") and len(parts) > 3 and path.endswith(".py"):
        names = (parts[2],)
    elif path.startswith(("docs/", "README.md")):
        names = PAGE_TESTS
    elif path.startswith("targets/stm32f4/"):
        names = ("docs/test_stm32f4_page.py",)
    elif path.startswith("examples/"):
        names = ("docs",)
    else:
        return []
    return [f"tests/python/{name}" for name in names if (ROOT / "tests/python" / name).exists()]


def is_script(path: str) -> bool:
    file = ROOT / path
    if not path.startswith((".ci/", "tools/", "tests/")) or not file.is_file():
        return False
    with file.open("rb") as stream:
        first = stream.readline(80)
    return first.startswith((b"#!/usr/bin/env bash", b"#!/bin/sh", b"# shellcheck shell=bash"))


def edit(paths: list[str]) -> list[str]:
    lines = [f"format {path}" for path in paths if SOURCE.search(path)]
    lines += [f"ruff {path}" for path in paths if path.endswith(".py")]
    lines += [f"script {path}" for path in paths if is_script(path)]
    lines += ["generated"] * any(GENERATED.search(path) for path in paths)
    lines += units(paths)
    lines += ["board"] * any(path.startswith(BOARD) for path in paths)
    tests = {test for path in paths for test in python_tests(path)}
    return lines + [f"pytest {test}" for test in sorted(tests)]


def counted(lines: list[str]) -> Counter[str]:
    counts: Counter[str] = Counter()
    for line in lines:
        number, path = line.split(" ", 1)
        counts[path] += int(number)
    return counts


def tidy(lines: list[str]) -> list[str]:
    """A header stands for the source beside it, or for one that includes it."""
    chosen: Counter[str] = Counter()
    for path, number in counted(lines).items():
        file = Path(path)
        if TIDY.search(path):
            chosen[path] += number
        elif file.suffix in (".h", ".hpp") and not path.startswith("tests/"):
            if source := source_of(file):
                chosen[source] += number
    return [path for path, _ in chosen.most_common(MOST_TIDY)]


def source_of(header: Path) -> str | None:
    folder = (ROOT / header).parent
    beside = [folder / f"{header.stem}{suffix}" for suffix in (".c", ".cpp")]
    within = sorted(folder.glob("*.c")) + sorted(folder.glob("*.cpp"))
    for source in [*beside, *(source for source in within if includes(source, {header.name}))]:
        path = str(source.relative_to(ROOT))
        if source.is_file() and TIDY.search(path):
            return path
    return None


def area(lines: list[str]) -> list[str]:
    counts: Counter[str] = Counter({"firmware": 0})
    for path, number in counted(lines).items():
        for found in areas_of(path) if SOURCE.search(path) else ():
            if found not in (*HEAVY_AREAS, "mps2", "support"):
                counts[found] += number
    return [counts.most_common(1)[0][0]]


def main(question: str) -> int:
    lines = [line for line in sys.stdin.read().splitlines() if line]
    answer = {"edit": edit, "tidy": tidy, "area": area}[question](lines)
    sys.stdout.write("".join(line + "\n" for line in answer))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
