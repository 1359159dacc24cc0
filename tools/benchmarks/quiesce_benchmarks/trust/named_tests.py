"""Tests that tables name: FILE::NAME, of Unity, of GoogleTest (Suite.name) or of pytest."""

import re
from pathlib import Path

FORMS = {
    ".c": r"^\s*RUN_TEST\({name}\);",
    ".cpp": r"^TEST(?:_F|_P)?\({suite}, {name}\)",
    ".py": r"^(?:async )?def {name}\(",
}


def parts(test: str) -> tuple[str, str]:
    """File and name. ValueError where it is no test's name."""
    file, separator, name = test.partition("::")
    if not separator or not name or Path(file).suffix not in FORMS:
        raise ValueError(f"{test}: expected FILE::NAME of a .c, .cpp or .py file")
    return file, name


def exists(test: str, root: Path) -> bool:
    """Whether its file has it, and for a C test runs it."""
    file, name = parts(test)
    if not (root / file).is_file():
        return False
    suite, _, short = name.rpartition(".")
    form = FORMS[Path(file).suffix].format(suite=re.escape(suite), name=re.escape(short))
    return re.search(form, (root / file).read_text(), re.MULTILINE) is not None


def missing(tests: list[str], root: Path) -> list[str]:
    return sorted({test for test in tests if not exists(test, root)})
