"""The scripts in tools/: what they say and how they exit when a machine lacks something.

Each test copies the scripts into a folder of its own (with a space in its name) and lets them see
only the commands that it puts on their PATH. Nothing here reaches the network.
"""

import fcntl
import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
SCRIPTS = ("bench_images", "bench_peers", "hil", "quiesce", "setup", "test")
COMMON = (
    "awk bash cat chmod cp cut dirname env flock grep mkdir mktemp mv nproc readlink rm "
    "sha256sum tail tar touch"
).split()
ALL_INSTALLED = 'shift 2; for p in "$@"; do echo "installed $p"; done'


class Clone:
    """A copy of the scripts and the commands that they can see."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "a clone"
        self.bin = folder / "bin"
        self.bin.mkdir()
        shutil.copytree(ROOT / "tools/lib", self.root / "tools/lib")
        for name in (*SCRIPTS, "packages.txt", "requirements.txt"):
            shutil.copy(ROOT / "tools" / name, self.root / "tools" / name)
        for name in COMMON:
            (self.bin / name).symlink_to(shutil.which(name))
        self.fake("id", "echo 1000")
        self.fake("sleep", "exit 0")
        self.fake("dpkg-query", ALL_INSTALLED)

    def fake(self, name: str, script: str) -> Path:
        """A command that notes its arguments in NAME.calls and then does what `script` says."""
        path = self.bin / name
        calls = self.bin / f"{name}.calls"
        path.write_text(f'#!/bin/bash\necho "$*" >>"{calls}"\n{script}\n')
        path.chmod(0o755)
        return path

    def calls(self, name: str) -> list[str]:
        path = self.bin / f"{name}.calls"
        return path.read_text().splitlines() if path.exists() else []

    def run(self, *command: str, **env: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            command,
            cwd=self.root,
            env={"PATH": str(self.bin), **env},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=60,
        )

    def script(self, name: str, *arguments: str, **env: str) -> subprocess.CompletedProcess[str]:
        return self.run(str(self.root / "tools" / name), *arguments, **env)

    def function(self, libraries: str, code: str, **env: str) -> subprocess.CompletedProcess[str]:
        """Runs `code` with some of tools/lib sourced."""
        sources = "; ".join(f"source tools/lib/{name}.sh" for name in libraries.split())
        return self.run("bash", "-c", f"PROGRAM=here; {sources}; {code}", **env)


@pytest.fixture
def clone(tmp_path: Path) -> Clone:
    return Clone(tmp_path)


def assert_one_line(result: subprocess.CompletedProcess[str], *words: str) -> None:
    assert result.returncode == 2, result.stderr
    assert result.stdout == ""
    assert len(result.stderr.strip().splitlines()) == 1, result.stderr
    for word in words:
        assert word in result.stderr


# Arguments


@pytest.mark.parametrize(
    ("name", "arguments", "words"),
    [
        ("setup", ["everything"], ["everything", "run, test, all or python"]),
        ("setup", ["run", "test"], ["one argument"]),
        ("bench_images", ["cmsis_cost", "all"], ["all", "signal_cost"]),
        ("bench_peers", ["python", "matlab"], ["matlab", "fuzzylite"]),
        ("test", ["--fast"], ["--fast", "--help"]),
        ("test", ["--only", "units"], ["units", "sanitize"]),
        ("test", ["--only"], ["--only", "sanitize"]),
    ],
)
def test_unknown_argument_is_refused(clone: Clone, name, arguments, words) -> None:
    assert_one_line(clone.script(name, *arguments), *words)
    assert not (clone.root / "build").exists()


@pytest.mark.parametrize("name", ["bench_images", "bench_peers", "setup", "test"])
def test_help_needs_nothing_installed(clone: Clone, name) -> None:
    result = clone.script(name, "--help")
    assert result.returncode == 0
    assert result.stdout.startswith("usage:")
    assert not (clone.root / "build").exists()


# Debian packages


def test_without_root_and_sudo_names_packages_and_command(clone: Clone) -> None:
    clone.fake("dpkg-query", ALL_INSTALLED + " | grep -v -e cmake -e qemu")
    clone.fake("apt-get", "exit 0")
    result = clone.script("setup", "run")
    assert_one_line(result, "apt-get install -y", "cmake qemu-system-arm")
    assert clone.calls("apt-get") == []


def test_without_apt_says_how_to_go_on(clone: Clone) -> None:
    clone.fake("dpkg-query", "exit 1")
    assert_one_line(clone.script("setup"), "no apt-get", "cmake", "QUIESCE_SKIP_PACKAGES=1")


def test_installs_only_what_is_missing_with_sudo(clone: Clone) -> None:
    clone.fake("dpkg-query", ALL_INSTALLED + " | grep -v -e cmake -e cppcheck")
    clone.fake("sudo", '[ "$1" = -n ] && shift; exec "$@"')
    clone.fake("true", "exit 0")
    clone.fake("apt-get", "exit 0")
    clone.script("setup", "test", QUIESCE_PYTHON="/none")
    update, install = clone.calls("apt-get")
    assert update.endswith("update")
    assert install.endswith("install -y --no-install-recommends cmake cppcheck")


def test_run_group_leaves_out_what_only_tests_need(clone: Clone) -> None:
    clone.fake("dpkg-query", ALL_INSTALLED + " | grep -v -e cppcheck")
    clone.fake("apt-get", "exit 0")
    clone.script("setup", "run", QUIESCE_PYTHON="/none")
    assert clone.calls("apt-get") == []


def test_password_prompt_without_terminal_is_not_waited_for(clone: Clone) -> None:
    clone.fake("dpkg-query", ALL_INSTALLED + " | grep -v -e cmake")
    clone.fake("sudo", "exit 1")
    clone.fake("apt-get", "exit 0")
    assert_one_line(clone.script("setup"), "cmake", "As root run")
    assert clone.calls("apt-get") == []


def test_names_the_package_that_cannot_be_had(clone: Clone) -> None:
    clone.fake("id", "echo 0")
    clone.fake("dpkg-query", ALL_INSTALLED + " | grep -v -e cmake -e clang-tidy")
    clone.fake("apt-get", '[[ "$*" != *install*clang-tidy* ]]')
    result = clone.script("setup", "test")
    assert result.returncode == 2
    last = result.stderr.splitlines()[-1]
    assert "do not offer: clang-tidy-14. " in last
    assert "Debian 12" in last


def test_all_packages_of_the_tests_come_in_one_go(clone: Clone) -> None:
    clone.fake("id", "echo 0")
    clone.fake("dpkg-query", "exit 1")
    clone.fake("apt-get", "exit 0")
    clone.script("setup", "all", QUIESCE_PYTHON="/none")
    update, install = clone.calls("apt-get")
    assert update.endswith("update")
    words = install.split()
    for name in ("cmake", "clang-14", "gcc-aarch64-linux-gnu", "mmdebstrap"):
        assert name in words
    assert "valgrind" not in words  # of benchmarks


def test_network_failure_is_tried_three_times_and_told_in_one_line(clone: Clone) -> None:
    clone.fake("id", "echo 0")
    clone.fake("dpkg-query", ALL_INSTALLED + " | grep -v -e cmake")
    clone.fake("apt-get", 'echo "E: no route"; [[ "$*" == *--simulate* ]]')
    result = clone.script("setup")
    assert result.returncode == 2
    last = result.stderr.splitlines()[-1]
    assert "could not install: cmake (E: no route). Check the network" in last
    assert len([call for call in clone.calls("apt-get") if call.endswith("cmake")]) == 3 + 1


# Python


def test_old_python_is_refused(clone: Clone) -> None:
    old = clone.fake("old", "echo 3 9 venv")
    assert_one_line(clone.script("setup", QUIESCE_PYTHON=str(old)), "3.11", f"{old} is 3.9.")


def test_python_without_venv_is_refused(clone: Clone) -> None:
    bare = clone.fake("bare", "echo 3 12")
    result = clone.script("setup", QUIESCE_PYTHON=str(bare))
    assert_one_line(result, f"{bare} is 3.12 without venv")


def test_missing_python_is_told(clone: Clone) -> None:
    assert_one_line(clone.script("setup", QUIESCE_PYTHON="/none"), "found: none")


def test_failed_package_download_is_one_line_with_pips_reason(clone: Clone) -> None:
    stub = 'if [ "$2" = pip ]; then echo "ERROR: no route"; exit 1; fi'
    make = 'mkdir -p "$3/bin"; cp "$0" "$3/bin/python"'
    cases = f"venv) {make};; pip) {stub};; *) echo 3 12 venv;;"
    python = clone.fake("python", f'[ "$1" != -I ] || shift; case "$2" in {cases} esac')
    result = clone.script("setup", QUIESCE_PYTHON=str(python))
    assert result.returncode == 2
    last = result.stderr.splitlines()[-1]
    assert "could not install the Python packages: ERROR: no route" in last
    assert len([call for call in clone.calls("python") if "install" in call]) == 3
    assert not (clone.root / ".venv/.complete").exists()


def test_interrupted_environment_is_made_again(clone: Clone) -> None:
    (clone.root / ".venv/bin").mkdir(parents=True)
    clone.fake("python", "echo Python 3.12.0").rename(clone.root / ".venv/bin/python")
    complete = "python_is_complete && echo complete"
    assert clone.function("common python", complete).stdout == ""
    clone.function("common python", "python_stamp >.venv/.complete")
    assert clone.function("common python", complete).stdout == "complete\n"
    with (clone.root / "tools/requirements.txt").open("a") as requirements:
        requirements.write("another==1.0\n")
    assert clone.function("common python", complete).stdout == ""


def test_moved_folder_gets_a_new_environment(clone: Clone) -> None:
    (clone.root / ".venv/bin").mkdir(parents=True)
    clone.fake("python", "echo Python 3.12.0").rename(clone.root / ".venv/bin/python")
    clone.function("common python", "python_stamp >.venv/.complete")
    clone.root = clone.root.rename(clone.root.with_name("elsewhere"))
    assert clone.function("common python", "python_is_complete || echo no").stdout == "no\n"


# Unity


def test_wrong_archive_is_refused_and_leaves_nothing(clone: Clone, tmp_path: Path) -> None:
    archive = tmp_path / "cantools-45.1.0.tar.gz"
    archive.write_bytes(b"not the archive")
    result = clone.function("common unity", "unity_setup", QUIESCE_UNITY_ARCHIVE=str(archive))
    assert result.returncode == 2
    assert "refused: its sha256 is" in result.stderr.splitlines()[-1]
    assert list((clone.root / "build/deps").iterdir()) == []


def test_missing_archive_is_named(clone: Clone) -> None:
    result = clone.function("common unity", "unity_setup", QUIESCE_UNITY_ARCHIVE="/none.tar.gz")
    assert result.returncode == 2
    assert "cannot read /none.tar.gz" in result.stderr.splitlines()[-1]


def test_changed_unity_file_is_noticed(clone: Clone) -> None:
    folder = clone.root / "build/deps/unity"
    shutil.copytree(ROOT / "build/deps/unity", folder)
    check = "unity_is_complete build/deps/unity && echo complete"
    assert clone.function("common unity", check).stdout == "complete\n"
    with (folder / "unity.c").open("a") as unity:
        unity.write("\n")
    assert clone.function("common unity", check).stdout == ""


# CMSIS-DSP


def test_wrong_cmsis_archive_is_refused_and_leaves_nothing(clone: Clone, tmp_path: Path) -> None:
    archive = tmp_path / "cmsisdsp-1.10.3.tar.gz"
    archive.write_bytes(b"not the archive")
    result = clone.function("common cmsis", "cmsis_setup", QUIESCE_CMSIS_ARCHIVE=str(archive))
    assert result.returncode == 2
    assert "refused: its sha256 is" in result.stderr.splitlines()[-1]
    assert list((clone.root / "build/deps").iterdir()) == []


def test_missing_cmsis_archive_is_named(clone: Clone) -> None:
    result = clone.function("common cmsis", "cmsis_setup", QUIESCE_CMSIS_ARCHIVE="/none.tar.gz")
    assert result.returncode == 2
    assert "cannot read /none.tar.gz" in result.stderr.splitlines()[-1]


def test_without_network_says_how_else_to_get_the_archive(clone: Clone) -> None:
    (clone.root / ".venv/bin").mkdir(parents=True)
    python = clone.fake("python", "echo 'ERROR: no network'; exit 1")
    (clone.root / ".venv/bin/python").symlink_to(python)
    result = clone.function("common python cmsis", "cmsis_setup")
    assert result.returncode == 2
    last = result.stderr.splitlines()[-1]
    assert "could not fetch cmsisdsp-1.10.3.tar.gz: ERROR: no network" in last
    assert "QUIESCE_CMSIS_ARCHIVE=" in last
    assert len(clone.calls("python")) == 3
    assert list((clone.root / "build/deps").iterdir()) == []


def test_interrupted_cmsis_set_up_starts_again(clone: Clone) -> None:
    folder = clone.root / "build/deps/cmsisdsp"
    folder.mkdir(parents=True)
    check = 'cmsis_is_complete build/deps/cmsisdsp && echo complete; echo "$CMSIS_SHA256"'
    checksum = clone.function("common cmsis", check).stdout
    assert len(checksum) == 65
    (folder / ".complete").write_text(checksum)
    assert clone.function("common cmsis", check).stdout == f"complete\n{checksum}"


# Two at once, results


def test_second_set_up_waits_for_the_first(clone: Clone) -> None:
    (clone.root / "build").mkdir()
    with (clone.root / "build/.setup.lock").open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        process = subprocess.Popen(
            [clone.root / "tools/setup", "run"],
            env={"PATH": str(clone.bin), "QUIESCE_PYTHON": "/none"},
            stderr=subprocess.PIPE,
            text=True,
        )
        assert "waiting for another command" in process.stderr.readline()
        assert process.poll() is None
    assert "3.11 or newer" in process.communicate(timeout=30)[1]
    assert process.returncode == 2


def test_failed_step_fails_the_run_and_shows_its_log(clone: Clone) -> None:
    code = "step good echo fine; step bad bash -c 'echo broken; exit 3' || true; report"
    result = clone.function("common steps", code)
    assert result.returncode == 1
    assert "broken\n" in result.stdout
    assert "steps: 1 passed, 1 failed" in result.stdout


def test_closing_lines_of_the_runners_come_last(clone: Clone) -> None:
    ctest = "100% tests passed, 0 tests failed out of 7"
    pytest_line = "====== 5 passed in 0.10s ======"
    code = f"step a echo '{ctest}'; step b echo '{pytest_line}'; report"
    result = clone.function("common steps", code)
    assert result.returncode == 0
    assert result.stdout.splitlines()[-2:] == [ctest, pytest_line]


# Gates: each one fails on what it is there for


@pytest.fixture
def tree(clone: Clone) -> Clone:
    """A tree with one clean C file, all gates, and every command of this machine."""
    shutil.copytree(ROOT / "tools/check", clone.root / "tools/check")
    for name in (".clang-format", ".clang-tidy", "ruff.toml"):
        shutil.copy(ROOT / name, clone.root)
    for (
        folder
    ) in "tools/benchmarks/mps2 firmware hal/mps2 linux sim_hil tests tools/gen .ci".split():
        (clone.root / folder).mkdir(parents=True)
    clean = "int clean(int a);\n\nint clean(int a) {\n    return a + 1;\n}\n"
    for name in (
        "tools/benchmarks/mps2/clean.c",
        "firmware/clean.c",
        "hal/mps2/clean.c",
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


def test_scripts_gate(tree: Clone) -> None:
    assert gate(tree, "scripts").returncode == 0
    (tree.root / "tools/bad").write_text("#!/bin/bash\nrm $1/*\n")
    assert gate(tree, "scripts").returncode != 0


def test_ruff_gate(tree: Clone) -> None:
    assert gate(tree, "ruff").returncode == 0
    (tree.root / "tests/bad.py").write_text("import os\n")
    assert gate(tree, "ruff").returncode != 0


def test_generated_gate(tree: Clone) -> None:
    (tree.root / "tools/gen/a.py").write_text("import sys\nsys.exit(sys.argv[1:] != ['--check'])\n")
    assert gate(tree, "generated").returncode == 0
    (tree.root / "tools/gen/b.py").write_text("raise SystemExit(1)\n")
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
    assert gate(tree, "tidy").returncode == 0
    lines = "".join(f"    a += a / {n};\n" for n in range(1, 62))
    (tree.root / "firmware/clean.c").write_text(f"int f(int a) {{\n{lines}    return a;\n}}\n")
    result = gate(tree, "tidy")
    assert result.returncode != 0
    assert "readability-function-size" in result.stdout


def test_tidy_gate_refuses_to_check_nothing(tree: Clone) -> None:
    compile_commands(tree, "host", "sim_hil/clean.cpp")
    compile_commands(tree, "mps2", "hal/mps2/clean.c")
    assert gate(tree, "tidy").returncode != 0
