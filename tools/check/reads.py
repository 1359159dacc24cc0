"""Print for every benchmark the Python files that it can import and the other files beside them, a
line each: `NAME FILE FILE ...`.

Imports inside functions and by name count. A benchmark that runs the command line reads all of
`tools`, which its line then says.
"""

import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BENCHMARKS = "quiesce_benchmarks"
# Starts whichever benchmark is asked for, and so imports them all.
STARTER = f"{BENCHMARKS}.__main__"
ALL = "tools"
COMMAND_LINE = re.compile(r"""["']quiesce["']|tools/(quiesce|hil)\b|quiesce\.(cli|__main__)""")


def reached(imports: Mapping[str, set[str]], roots: set[str]) -> set[str]:
    found, left = set(), set(roots)
    while left:
        name = left.pop()
        found.add(name)
        left |= imports.get(name, set()) - found - {STARTER}
    return found


def folders_of(names: Iterator[str]) -> set[str]:
    """Of each module the packages that it is in: their __init__ is run as well."""
    found: set[str] = set()
    for name in names:
        parts = name.split(".")
        found |= {".".join(parts[:count]) for count in range(1, len(parts))}
    return found


def beside(folder: Path) -> list[str]:
    """Files that are no Python: of the package, of this benchmark, of what judges it."""
    package = (ROOT / "tools/src/quiesce").rglob("*")
    own = [*folder.rglob("*"), *folder.parent.iterdir()]
    judge = [ROOT / "tools/benchmark", ROOT / "tools/check/benchmark.py"]
    found = [file for file in (*package, *own) if file.is_file() and is_read(file)]
    return [str(file.relative_to(ROOT)) for file in (*found, *judge)]


def is_read(file: Path) -> bool:
    return file.suffix not in (".py", ".pyc", ".so")


def lines() -> Iterator[str]:
    sys.path.insert(0, str(ROOT / "tests/python/gates"))
    from house.python_sources import Package

    package = Package(ROOT)
    for folder in sorted((ROOT / "tools/benchmarks" / BENCHMARKS).iterdir()):
        own = f"{BENCHMARKS}.{folder.name}"
        if not (folder / "benchmark.py").is_file():
            continue
        roots = {name for name in package.modules if name == own or name.startswith(f"{own}.")}
        names = reached(package.imports, roots | {"quiesce.engine.bench"})
        names |= folders_of(iter(names)) & set(package.modules)
        files = sorted({package.modules[name].path for name in names})
        ours = [file for file in files if f"/{BENCHMARKS}/" in file]
        is_whole = any(COMMAND_LINE.search((ROOT / file).read_text()) for file in ours)
        paths = sorted({*files, *beside(folder)})
        yield f"{folder.name} {ALL if is_whole else ' '.join(paths)}"


if __name__ == "__main__":
    print("\n".join(lines()))
