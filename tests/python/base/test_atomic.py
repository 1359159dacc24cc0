"""Files that appear complete or not at all, where the disk takes no more."""

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError

SRC = Path(__file__).resolve().parents[3] / "tools/src"
LEAST_BYTES = 100  # that a file may have in a test of a full disk
COMMANDS = (
    ("identify example --out {}/example.csv", "example.csv"),
    ("identify plan --stroke-mm 50 --max-force-N 2000 --max-current-A 2 --out {}", "plan.csv"),
    ("sweep --out {}/excitation.csv --band 3 60 --drive 0.1 --max-current 2", "excitation.csv"),
    ("rules convert {root}/firmware/plants/squeeze_2012/rules.fcl --to fis --out {}/my.fis",
     "my.fis"),
    ("rules compile {root}/firmware/plants/squeeze_2012/rules.fcl --out {}", ""),
)  # fmt: skip


def limit_files() -> None:
    """A file that grows further gives EFBIG, as a full disk gives ENOSPC."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LEAST_BYTES, LEAST_BYTES))


@pytest.mark.parametrize(("words", "name"), COMMANDS)
def test_a_full_disk_is_told_in_one_line_and_leaves_nothing(
    words: str, name: str, tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "before").touch()
    call = words.format(folder, root=SRC.parents[1]).split()
    result = subprocess.run(
        [sys.executable, "-B", "-m", "quiesce", *call],
        env={"PYTHONPATH": str(SRC), "PATH": "/usr/bin:/bin", "MPLCONFIGDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        preexec_fn=limit_files,
    )
    assert (result.returncode, result.stdout) == (2, ""), result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert f"cannot write {folder}/{name}" in result.stderr
    assert "File too large" in result.stderr
    assert [file.name for file in folder.iterdir()] == ["before"]


def test_a_file_of_before_stays_where_the_disk_is_full(tmp_path: Path) -> None:
    file = tmp_path / "report.txt"
    file.write_text("old")
    with pytest.raises(UsageError, match=f"^cannot write {file}: No space left on device$"):
        with output_files(tmp_path) as staging:
            (staging / "report.txt").write_text("half")
            Path("/dev/full").write_text("more")
    assert file.read_text() == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_another_error_is_not_taken_for_a_full_disk(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), output_files(tmp_path):
        (tmp_path / "none").read_text()


def test_a_pipe_takes_what_is_written_and_stays_one(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        with output_files(tmp_path) as staging:
            (staging / "pipe").write_text("new")
        assert os.read(reader, 10) == b"new"
        assert pipe.is_fifo()
    finally:
        os.close(reader)


def test_a_folder_joins_the_one_that_is_there(tmp_path: Path) -> None:
    for name in ("first", "second"):
        with output_files(tmp_path / "out") as staging:
            (staging / "shots").mkdir()
            (staging / "shots" / name).write_text(name)
            (staging / "shots" / "both").write_text(name)
    files = {file.name: file.read_text() for file in (tmp_path / "out/shots").iterdir()}
    assert files == {"first": "first", "second": "second", "both": "second"}
