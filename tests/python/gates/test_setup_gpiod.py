"""Set-up of libgpiod 2.x refuses what is not the archive, and says how else to get it."""

from pathlib import Path

import pytest
from test_setup_scripts import Clone

SETUP = "common python gpiod"


@pytest.fixture
def scripts(tmp_path: Path) -> Clone:
    return Clone(tmp_path)


def test_wrong_gpiod_archive_is_refused_and_leaves_nothing(scripts: Clone, tmp_path: Path) -> None:
    archive = tmp_path / "gpiod-2.5.0.tar.gz"
    archive.write_bytes(b"not the archive")
    result = scripts.function(SETUP, "gpiod_setup", QUIESCE_GPIOD_ARCHIVE=str(archive))
    assert result.returncode == 2
    assert "refused: its sha256 is" in result.stderr.splitlines()[-1]
    assert list((scripts.root / "build/deps").iterdir()) == []


def test_missing_gpiod_archive_is_named(scripts: Clone) -> None:
    result = scripts.function(SETUP, "gpiod_setup", QUIESCE_GPIOD_ARCHIVE="/none.tar.gz")
    assert result.returncode == 2
    assert "cannot read /none.tar.gz" in result.stderr.splitlines()[-1]


def test_without_network_says_how_else_to_get_gpiod(scripts: Clone) -> None:
    (scripts.root / ".venv/bin").mkdir(parents=True)
    python = scripts.fake("python", "echo 'ERROR: no network'; exit 1")
    (scripts.root / ".venv/bin/python").symlink_to(python)
    result = scripts.function(SETUP, "gpiod_setup")
    assert result.returncode == 2
    last = result.stderr.splitlines()[-1]
    assert "could not fetch gpiod-2.5.0.tar.gz: ERROR: no network" in last
    assert "QUIESCE_GPIOD_ARCHIVE=" in last
    assert list((scripts.root / "build/deps").iterdir()) == []


def test_interrupted_gpiod_set_up_starts_again(scripts: Clone) -> None:
    folder = scripts.root / "build/deps/gpiod"
    folder.mkdir(parents=True)
    check = 'gpiod_is_complete build/deps/gpiod && echo complete; echo "$GPIOD_SHA256"'
    checksum = scripts.function(SETUP, check).stdout
    assert len(checksum) == 65
    (folder / ".complete").write_text(checksum)
    assert scripts.function(SETUP, check).stdout == f"complete\n{checksum}"
