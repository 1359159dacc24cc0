"""./tools/test: its steps, what it does not run again, what it says."""

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from script_clone import Clone


@pytest.fixture
def clone(tmp_path: Path) -> Clone:
    return Clone(tmp_path)


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


LANES = """
one() { step "$1" bash -c "echo '====== 1 passed in 0.$1s ======'; [ $1 != 3 ]"; }
side_by_side 2 one 1 2 3 4 5 >told; report
"""


def test_steps_side_by_side_are_recorded_as_if_by_themselves(clone: Clone) -> None:
    result = clone.function("common steps lanes", LANES)
    assert result.returncode == 1
    assert "failed: 3\n" in result.stdout
    assert "steps: 4 passed, 1 failed\n" in result.stdout
    closing = {f"====== 1 passed in 0.{number}s ======" for number in range(1, 6)}
    assert set(result.stdout.splitlines()[-5:]) == closing
    told = (clone.root / "told").read_text()
    assert all(f"ok    {number} " in told for number in (1, 2, 4, 5)) and "FAIL  3 " in told


def test_steps_side_by_side_run_at_once(clone: Clone) -> None:
    """Each waits for the other."""
    meet = "touch $1; until [ -e a ] && [ -e b ]; do [ $SECONDS -lt 20 ] || exit 1; done"
    code = f"one() {{ step $1 bash -c '{meet}' - $1; }}; side_by_side 2 one a b; report"
    result = clone.function("common steps lanes", code)
    assert "steps: 2 passed, 0 failed" in result.stdout, result.stdout + result.stderr


def test_ctrl_c_ends_what_runs_side_by_side(clone: Clone) -> None:
    forever = "echo >$1; exec 3<>pipe; read -r _ <&3"
    steps = f"one() {{ step $1 bash -c '{forever}' - $1; }}; side_by_side 2 one a b c"
    (clone.bin / "mkfifo").symlink_to(shutil.which("mkfifo"))
    libraries = "; ".join(f"source tools/lib/{name}.sh" for name in ("common", "steps", "lanes"))
    run = subprocess.Popen(
        ["bash", "-c", f"PROGRAM=here; {libraries}; mkfifo pipe; {steps}"],
        cwd=clone.root,
        env={"PATH": str(clone.bin)},
        stdin=subprocess.DEVNULL,
        start_new_session=True,
    )
    give_up_s = time.monotonic() + 60.0
    while not all((clone.root / name).exists() for name in "ab"):
        assert time.monotonic() < give_up_s and run.poll() is None
        time.sleep(0.05)
    os.killpg(run.pid, signal.SIGINT)
    assert run.wait(30) == 130
    while of_session(run.pid):
        assert time.monotonic() < give_up_s
        time.sleep(0.05)
    assert not (clone.root / "c").exists()


def of_session(number: int) -> list[str]:
    """Processes that are left of it."""
    call = ["ps", "-o", "pid=", "-s", str(number)]
    return subprocess.run(call, capture_output=True, text=True).stdout.split()


def repository(clone: Clone) -> Callable[..., str]:
    """The clone as a git tree with all of git, and a .venv that says it is complete."""

    def git(*words: str) -> str:
        call = ["git", "-c", "user.name=a", "-c", "user.email=a@b", *words]
        options = {"cwd": clone.root, "check": True, "capture_output": True, "text": True}
        return subprocess.run(call, **options).stdout

    for name in ("cut", "gcc", "git", "head", "sed", "sort", "uname", "xargs"):
        if not (clone.bin / name).exists():
            (clone.bin / name).symlink_to(shutil.which(name))
    (clone.root / "firmware").mkdir()
    (clone.root / "firmware/a.c").write_text("1\n")
    (clone.root / "docs").mkdir()
    (clone.root / "docs/a.md").write_text("1\n")
    (clone.root / ".venv").mkdir()
    (clone.root / ".venv/.complete").write_text("complete\n")
    (clone.root / ".gitignore").write_text("/build/\n/.venv/\n")
    git("init", "-q", "-b", "main")
    git("add", "-A")
    git("commit", "-q", "-m", "one")
    return git


RESUME = "MODE=resume; if wants ctest-host; then step ctest-host {}; fi"


@pytest.mark.parametrize(
    ("file", "is_run_again"),
    [
        ("firmware/a.c", True),
        ("firmware/new.c", True),
        ("tools/lib/steps.sh", True),
        ("docs/a.md", False),
        ("tests/summary.md", False),
    ],
)
def test_a_step_is_run_again_where_its_inputs_changed(clone: Clone, file, is_run_again) -> None:
    repository(clone)
    line = "100% tests passed, 0 tests failed out of 7"
    first = clone.function("common steps", RESUME.format(f"echo '{line}'") + "; report").stdout
    assert "ok    ctest-host" in first
    again = clone.function("common steps", RESUME.format("false") + "; report")
    assert again.returncode == 0
    assert "kept  ctest-host" in again.stdout
    assert again.stdout.splitlines()[-1] == line
    (clone.root / file).parent.mkdir(exist_ok=True)
    with (clone.root / file).open("a") as stream:
        stream.write("\n")
    changed = clone.function("common steps", RESUME.format("true") + "; report").stdout
    assert ("ok    ctest-host" in changed) == is_run_again
    assert ("kept  ctest-host" in changed) != is_run_again


def test_a_part_of_a_step_is_no_reason_to_keep_it(clone: Clone) -> None:
    repository(clone)
    clone.function("common steps", f"STAMPED=0; {RESUME.format('echo part')}")
    result = clone.function("common steps", f"{RESUME.format('echo whole')}; report")
    assert "steps: 1 passed, 0 failed\n" in result.stdout


def test_a_file_that_changes_during_the_run_is_no_reason_to_keep_a_step(clone: Clone) -> None:
    repository(clone)
    edit = "echo 2 >firmware/a.c"  # after the build, before the step
    clone.function("common steps", f"{edit}; {RESUME.format('echo old program')}")
    result = clone.function("common steps", f"{RESUME.format('echo new')}; report")
    assert "steps: 1 passed, 0 failed\n" in result.stdout


def test_a_step_that_failed_is_run_again(clone: Clone) -> None:
    repository(clone)
    clone.function("common steps", RESUME.format("true"))
    clone.function("common steps", "step ctest-host false")
    assert "kept" not in clone.function("common steps", RESUME.format("true")).stdout


def test_another_machine_goes_on_with_what_the_summary_says(clone: Clone) -> None:
    for name in ("date", "grep", "nproc"):
        if not (clone.bin / name).exists():
            (clone.bin / name).symlink_to(shutil.which(name))
    repository(clone)
    (clone.root / "tests").mkdir()
    both = RESUME.format("echo '== 5 passed in 1s =='") + "; MODE=run; step ctest-m32 true"
    clone.function("common steps", f"{both}; step ctest-m3 false || true; write_summary")

    def elsewhere() -> None:
        shutil.rmtree(clone.root / "build", ignore_errors=True)

    elsewhere()
    again = clone.function("common steps", f"{RESUME.format('false')}; report; write_summary")
    assert again.returncode == 0 and "kept  ctest-host" in again.stdout
    assert again.stdout.splitlines()[-1] == "5 passed in 1s"
    text = (clone.root / "tests/summary.md").read_text()
    rows = [line.split(" | ")[:2] for line in text.splitlines() if line.startswith("| ctest")]
    assert rows == [["| ctest-host", "kept"], ["| ctest-m32", "before"]]
    elsewhere()
    m32 = "MODE=resume; wants ctest-m32 || true; wants ctest-m3 && echo runs m3"
    result = clone.function("common steps", m32).stdout
    assert "kept  ctest-m32" in result and "runs m3" in result
    # What has failed here is run again, whatever is said elsewhere.
    clone.function("common steps", "step ctest-host false")
    assert "ok    ctest-host" in clone.function("common steps", RESUME.format("true")).stdout
    elsewhere()
    (clone.root / ".venv/.complete").write_text("complete\n/in/another/folder\n")
    assert "kept  ctest-m32" in clone.function("common steps", m32).stdout
    (clone.root / "firmware/a.c").write_text("2\n")
    assert "ok    ctest-host" in clone.function("common steps", RESUME.format("true")).stdout


def test_without_git_every_step_is_run(clone: Clone) -> None:
    for _ in range(2):
        result = clone.function("common steps", RESUME.format("true"))
        assert result.stdout.startswith("ok    ctest-host")


def test_an_absent_tool_is_said_and_is_no_pass(clone: Clone) -> None:
    result = clone.function("common steps", 'absent proofs "no prover"; report')
    assert result.returncode == 0
    assert "not run here: proofs" in result.stdout
    assert "steps: 0 passed, 0 failed" in result.stdout


def test_a_long_step_says_that_it_is_alive(clone: Clone) -> None:
    (clone.bin / "sleep").unlink()
    (clone.bin / "sleep").symlink_to(shutil.which("sleep"))
    result = clone.function("common steps", "ALIVE_EVERY_S=1; step slow sleep 2.5")
    assert "...   slow 1 s" in result.stderr
    assert "ok    slow" in result.stdout


def test_summary_names_every_step_and_the_commit(clone: Clone) -> None:
    for name in ("date", "nproc", "sed"):
        if not (clone.bin / name).exists():
            (clone.bin / name).symlink_to(shutil.which(name))
    git = repository(clone)
    (clone.root / "tests").mkdir()
    code = "step a echo '== 5 passed in 1s =='; step b false || true; absent c why; write_summary"
    assert clone.function("common steps", code).returncode == 0
    text = (clone.root / "tests/summary.md").read_text()
    assert f"- commit {git('rev-parse', '--short=12', 'HEAD').strip()}\n" in text
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    assert [row.split(" | ")[0:2] for row in rows[1:]] == [
        ["| a", "passed"], ["| b", "FAILED"], ["| c", "absent"],
    ]  # fmt: skip
    assert "5 passed in 1s" in rows[1]
    assert "why" in rows[3]


def base_of(clone: Clone, **env: str) -> str:
    return clone.function("common changes", "changed_base", **env).stdout.strip()


def test_a_branch_is_compared_with_where_it_left_main(clone: Clone) -> None:
    git = repository(clone)
    one = git("rev-parse", "HEAD").strip()
    assert base_of(clone) == ""
    git("checkout", "-q", "-b", "work")
    for _ in range(2):
        git("commit", "-q", "--allow-empty", "-m", "more")
    assert base_of(clone) == one
    before_last = git("rev-parse", "HEAD~1").strip()
    git("branch", "-q", "-f", "main", "work")
    assert base_of(clone) == before_last
    assert base_of(clone, QUIESCE_BASE=one) == one


def test_changed_files_are_counted_by_lines_and_new_ones_are_seen(clone: Clone) -> None:
    git = repository(clone)
    git("commit", "-q", "--allow-empty", "-m", "two")
    (clone.root / "firmware/a.c").write_text("2\n3\n")
    (clone.root / "firmware/b.c").write_text("4\n")
    lines = clone.function("common changes", "changed_lines").stdout.splitlines()
    assert lines == ["3 firmware/a.c", "100 firmware/b.c"]
    edited = clone.function("common changes", "edited_files").stdout.splitlines()
    assert edited == ["firmware/a.c", "firmware/b.c"]
