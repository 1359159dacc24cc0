"""The firmware's own C, built for this machine with the system's compiler."""

import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.paths import cache_folder, root

FIRMWARE_SOURCES = (
    "fuzzy/fuzzy.c",
    "fuzzy/fuzzy_centroid.c",
    "fuzzy/fuzzy_partition.c",
    "fuzzy/fuzzy_surface.c",
    "fuzzy/fuzzy_table.c",
    "base/crc32.c",
)
SYSTEM_SOURCES = (
    "fuzzy/fuzzy_system.c",
    "fuzzy/fuzzy_curve.c",
    "fuzzy/fuzzy_system_check.c",
    "fuzzy/fuzzy_defuzzify.c",
    "fuzzy/fuzzy_formula.c",
    "fuzzy/fuzzy_norms.c",
    "base/fixq.c",
    "base/crc32.c",
)
FLAGS = ("-std=c11", "-O2", "-fno-strict-aliasing", "-Wall", "-Wextra", "-Werror")


def firmware_sources(names: Sequence[str] = FIRMWARE_SOURCES) -> list[Path]:
    return [root() / "firmware" / name for name in names]


def compiler() -> str:
    """$CC or cc. UsageError where there is none."""
    name = os.environ.get("CC", "cc")
    if shutil.which(name) is None:
        raise UsageError(
            f"no C compiler '{name}': install one (Debian: gcc, libc6-dev), or name it in CC"
        )
    return name


def build(
    sources: Sequence[Path], texts: Mapping[str, str], flags: Sequence[str], suffix: str = ".so"
) -> Path:
    """A program (suffix "") or shared library of these files and of the C texts, built once.

    texts: file name and contents; what ends in .c is compiled, the rest may be included. The result
    lies in rules/ of the cache (build/ in a checkout), named by the hash of all that it is made of.
    """
    folders = [*(root() / "firmware" / name for name in ("base", "fuzzy"))]
    folders += sorted({file.parent for file in sources} - set(folders))
    headers = [file for folder in folders for file in sorted(folder.glob("*.h"))]
    command = [compiler(), *FLAGS, *flags]
    parts = [*command, suffix, *(text for item in sorted(texts.items()) for text in item)]
    digest = hashlib.sha256("\0".join(parts).encode())
    for file in [*sources, *headers]:
        digest.update(file.read_bytes())
    folder = cache_folder() / "rules"
    result = folder / f"{digest.hexdigest()[:24]}{suffix}"
    if not result.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            included = [f"-I{folder}" for folder in [*folders, scratch]]
            compile_into(Path(scratch), [*command, *included], sources, texts, result)
    return result


def compile_into(
    scratch: Path,
    command: Sequence[str],
    sources: Sequence[Path],
    texts: Mapping[str, str],
    result: Path,
) -> None:
    for name, text in texts.items():
        (scratch / name).write_text(text, encoding="utf-8")
    made = scratch / "made"
    shared = ("-shared", "-fPIC") if result.suffix == ".so" else ()
    own = [scratch / name for name in texts if name.endswith(".c")]
    process = subprocess.run(
        [*command, *shared, *map(str, [*sources, *own]), "-lm", "-o", str(made)],
        capture_output=True,
        text=True,
    )
    if process.returncode != 0:
        raise BenchFailure(f"the C compiler refused: {one_line(process.stderr)[:300]}")
    made.replace(result)
