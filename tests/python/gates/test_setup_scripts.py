"""The scripts in tools/: what they say and how they exit when a machine lacks something.

Each test copies the scripts into a folder of its own (with a space in its name) and lets them see
only the commands that it puts on their PATH. Nothing here reaches the network.
"""

import fcntl
import shutil
import subprocess
from pathlib import Path

import pytest
from script_clone import ALL_INSTALLED, ROOT, SCRIPTS, Clone


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
        ("benchmarks/build_images", ["cmsis_cost", "all"], ["all", "signal_cost"]),
        ("benchmarks/fetch_peers", ["python", "matlab"], ["matlab", "fuzzylite"]),
        ("test", ["--fast"], ["--fast", "--help"]),
        ("test", ["--only", "units"], ["units", "sanitize"]),
        ("test", ["edit", "--list"], ["--list", "--help"]),
        ("test", ["--only"], ["--only", "sanitize"]),
        ("test", ["edit", "all"], ["one of edit, all and --only"]),
        ("test", ["edit", "--only", "unit"], ["one of edit, all and --only"]),
        ("test", ["--again"], ["--again goes with all"]),
    ],
)
def test_unknown_argument_is_refused(clone: Clone, name, arguments, words) -> None:
    assert_one_line(clone.script(name, *arguments), *words)
    assert not (clone.root / "build").exists()


@pytest.mark.parametrize("name", [*SCRIPTS[:2], "setup", "test"])
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


def in_use(clone: Clone) -> None:
    """The clone has a complete environment, of an older layout."""
    (clone.root / ".venv/bin").mkdir(parents=True)
    clone.fake("python", "echo Python 3.12.0").rename(clone.root / ".venv/bin/python")
    clone.function("common python", "python_stamp >.venv/.complete")


def want_more(clone: Clone) -> None:
    with (clone.root / "tools/requirements.txt").open("a") as requirements:
        requirements.write("another==1.0\n")


def test_failed_set_up_leaves_the_environment_in_use(clone: Clone) -> None:
    in_use(clone)
    want_more(clone)
    make = 'mkdir -p "$3/bin"; cp "$0" "$3/bin/python"'
    cases = f"venv) {make};; pip) exit 1;; *) echo 3 12 venv;;"
    python = clone.fake("python", f'[ "$1" != -I ] || shift; case "$2" in {cases} esac')
    for _ in range(3):
        assert clone.script("setup", "python", QUIESCE_PYTHON=str(python)).returncode == 2
        assert len(list((clone.root / ".venvs").iterdir())) == 1  # they do not pile up
    usable = clone.function("common launch", "python_is_usable && .venv/bin/python -V")
    assert usable.stdout == "Python 3.12.0\n"


def test_new_environment_takes_the_place_of_the_old(clone: Clone) -> None:
    in_use(clone)
    make = 'mkdir -p "$3/bin" "$3/site"; cp "$0" "$3/bin/python"'
    where = 'echo "${0%/bin/python}/site"'
    cases = f"*-m\\ venv*) {make};; *sysconfig*) {where};; *-m\\ pip*) ;; *) echo 3 12 venv;;"
    python = clone.fake("python", f'[ "$1" != -I ] || shift; case "$*" in {cases} esac')
    before = "before"
    for _ in range(3):
        want_more(clone)
        result = clone.script("setup", "python", QUIESCE_PYTHON=str(python))
        assert result.returncode == 0, result.stderr
        assert (clone.root / ".venv").is_symlink()
        assert (clone.root / ".venv/site/quiesce.pth").exists()
        assert clone.function("common python", "python_is_complete && echo yes").stdout == "yes\n"
        kept = {folder.name for folder in (clone.root / ".venvs").iterdir()}
        assert before in kept and len(kept) == 2  # it may be in use
        before = (clone.root / ".venv").readlink().name


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


# Two at once


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
