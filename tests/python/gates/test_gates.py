"""The gates in tools/check: each one fails on what it is there for."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from script_clone import ROOT, Clone


@pytest.fixture
def clone(tmp_path: Path) -> Clone:
    return Clone(tmp_path)


@pytest.fixture
def tree(clone: Clone) -> Clone:
    """A tree with one clean C file, all gates, and every command of this machine."""
    shutil.copytree(ROOT / "tools/check", clone.root / "tools/check")
    for name in (".clang-format", ".clang-tidy", "ruff.toml"):
        shutil.copy(ROOT / name, clone.root)
    for folder in (
        "tools/benchmarks/mps2 tools/benchmarks/host tools/benchmarks/gen tools/gen tests/gen "
        "firmware hal/mps2 targets/lockstep targets/mps2 targets/stm32f4 sim_hil tests/unit .ci "
        "examples"
    ).split():
        (clone.root / folder).mkdir(parents=True, exist_ok=True)
    clean = "int clean(int a);\n\nint clean(int a) {\n    return a + 1;\n}\n"
    for name in (
        "tools/benchmarks/mps2/clean.c",
        "firmware/clean.c",
        "hal/mps2/clean.c",
        "targets/stm32f4/clean.c",
        "sim_hil/clean.cpp",
    ):
        (clone.root / name).write_text(clean)
    (clone.root / ".venv").symlink_to(ROOT / ".venv")
    return clone


def gate(tree: Clone, name: str) -> subprocess.CompletedProcess[str]:
    return tree.script(f"check/{name}", PATH=os.environ["PATH"])


def test_format_gate(tree: Clone) -> None:
    assert gate(tree, "format").returncode == 0
    (tree.root / "sim_hil/bad.cpp").write_text("int  bad( ) {return 1;}\n")
    assert gate(tree, "format").returncode != 0


def test_cppcheck_gate(tree: Clone) -> None:
    assert gate(tree, "cppcheck").returncode == 0
    (tree.root / "firmware/bad.c").write_text(
        "int bad(void);\nint bad(void) { int a[2] = {1, 2}; return a[2]; }\n"
    )
    assert gate(tree, "cppcheck").returncode != 0


@pytest.mark.slow
def test_scripts_gate(tree: Clone) -> None:
    assert gate(tree, "scripts").returncode == 0
    (tree.root / "tools/bad").write_text("#!/bin/bash\nrm $1/*\n")
    assert gate(tree, "scripts").returncode != 0


def test_ruff_gate(tree: Clone) -> None:
    assert gate(tree, "ruff").returncode == 0
    (tree.root / "tests/bad.py").write_text("import os\n")
    assert gate(tree, "ruff").returncode != 0


@pytest.mark.parametrize("folder", ["tools/gen", "tools/benchmarks/gen", "tests/gen"])
def test_generated_gate(tree: Clone, folder: str) -> None:
    for name in ("tools/gen", "tools/benchmarks/gen", "tests/gen"):
        agrees = "import sys\nsys.exit(sys.argv[1:] != ['--check'])\n"
        (tree.root / name / "a.py").write_text(agrees)
    assert gate(tree, "generated").returncode == 0
    (tree.root / folder / "b.py").write_text("raise SystemExit(1)\n")
    assert gate(tree, "generated").returncode != 0


def compile_commands(tree: Clone, build: str, *names: str) -> None:
    folder = tree.root / "build" / build
    folder.mkdir(parents=True, exist_ok=True)
    directory = str(tree.root)
    entries = [
        {"directory": directory, "file": f"{directory}/{name}", "arguments": ["cc", "-c", name]}
        for name in names
    ]
    (folder / "compile_commands.json").write_text(json.dumps(entries))


def test_tidy_gate(tree: Clone) -> None:
    compile_commands(tree, "host", "firmware/clean.c", "sim_hil/clean.cpp")
    compile_commands(tree, "mps2", "hal/mps2/clean.c")
    compile_commands(tree, "stm32f4", "targets/stm32f4/clean.c")
    assert gate(tree, "tidy").returncode == 0
    lines = "".join(f"    a += a / {n};\n" for n in range(1, 62))
    (tree.root / "firmware/clean.c").write_text(f"int f(int a) {{\n{lines}    return a;\n}}\n")
    result = gate(tree, "tidy")
    assert result.returncode != 0
    assert "readability-function-size" in result.stdout


def test_tidy_gate_reads_only_what_is_named(tree: Clone) -> None:
    compile_commands(tree, "host", "firmware/clean.c", "firmware/bad.c", "sim_hil/clean.cpp")
    compile_commands(tree, "mps2", "hal/mps2/clean.c")
    compile_commands(tree, "stm32f4", "targets/stm32f4/clean.c")
    lines = "".join(f"    a += a / {n};\n" for n in range(1, 62))
    (tree.root / "firmware/bad.c").write_text(f"int f(int a) {{\n{lines}    return a;\n}}\n")
    tidy = [str(tree.root / "tools/check/tidy")]
    path = os.environ["PATH"]
    assert tree.run(*tidy, "firmware/clean.c", "sim_hil/none.cpp", PATH=path).returncode == 0
    assert tree.run(*tidy, "firmware/clean.c", "firmware/bad.c", PATH=path).returncode != 0


def test_what_was_clean_is_looked_at_again_once_it_differs(tree: Clone) -> None:
    (tree.root / "firmware/part.h").write_text("#define PART 3\n")
    clean = tree.root / "firmware/clean.c"
    clean.write_text('#include "part.h"\nint f(void);\nint f(void) {\n    return PART;\n}\n')
    compile_commands(tree, "host", "firmware/clean.c")
    found = tree.root / "build/tidied"

    def looked_at() -> int:
        command = [".venv/bin/python", "tools/check/tidy_file.py", "build/host", "firmware/clean.c"]
        assert tree.run(*command, PATH=os.environ["PATH"]).returncode == 0
        return len(list(found.iterdir()))

    assert looked_at() == 1
    assert looked_at() == 1
    (tree.root / "firmware/part.h").write_text("#define PART 4\n")
    assert looked_at() == 2
    clean.write_text(clean.read_text().replace("return PART;", "return PART; // NOLINT"))
    assert looked_at() == 3
    with (tree.root / ".clang-tidy").open("a") as settings:
        settings.write("# changed\n")
    assert looked_at() == 4


def test_what_tidy_finds_is_found_again(tree: Clone) -> None:
    compile_commands(tree, "host", "firmware/bad.c")
    lines = "".join(f"    a += a / {n};\n" for n in range(1, 62))
    (tree.root / "firmware/bad.c").write_text(f"int f(int a) {{\n{lines}    return a;\n}}\n")
    command = [".venv/bin/python", "tools/check/tidy_file.py", "build/host", "firmware/bad.c"]
    for _ in range(2):
        assert tree.run(*command, PATH=os.environ["PATH"]).returncode != 0
    (tree.root / "firmware/bad.c").write_text('#include "none.h"\n')
    assert tree.run(*command, PATH=os.environ["PATH"]).returncode != 0
    assert not (tree.root / "build/tidied").exists()


def test_tidy_gate_refuses_to_check_nothing(tree: Clone) -> None:
    compile_commands(tree, "host", "sim_hil/clean.cpp")
    compile_commands(tree, "mps2", "hal/mps2/clean.c")
    compile_commands(tree, "stm32f4", "targets/stm32f4/clean.c")
    assert gate(tree, "tidy").returncode != 0
