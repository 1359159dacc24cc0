"""Figures that the project's files alone decide."""

import json
import re
import sys
from pathlib import Path

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import root

from quiesce_benchmarks.house.timed import run_timed


def flat_modules(project: Path) -> int:
    """Python files that lie in the package's root."""
    return len(list((project / "tools/src/quiesce").glob("*.py")))


def firmware_rig_names(project: Path) -> int:
    """Mentions of a rig in the firmware's C outside of firmware/plants."""
    firmware = project / "firmware"
    rigs = [one.name for one in (firmware / "plants").iterdir() if one.is_dir()]
    rigs += [one.stem for one in (project / "sim_hil/data/plants").glob("*.toml")]
    pattern = re.compile("|".join(map(re.escape, sorted(set(rigs)))))
    files = [file for kind in ("*.c", "*.h") for file in firmware.rglob(kind)]
    outside = [file for file in files if "plants" not in file.relative_to(firmware).parts]
    return sum(len(pattern.findall(file.read_text(encoding="utf-8"))) for file in outside)


def golden_words_differing() -> tuple[int, int]:
    """Hash words that differ from the recorded ones, of how many."""
    done = run_timed([root() / "tools/golden", "check", "--json"], root())
    found = re.search(r"^\{.*\}$", done.output, re.MULTILINE)
    if found is None:
        raise BenchFailure(f"tools/golden check: {done.last_line}")
    result = json.loads(found.group(0))
    return result["differing"], result["words"]


def import_circles() -> list[list[str]]:
    """Over C, C++ and Python, by the architecture test's own reading of the sources."""
    sys.path.insert(0, str(root() / "tests/python/gates"))
    try:
        import house
    finally:
        sys.path.pop(0)
    return house.import_circles(root())
