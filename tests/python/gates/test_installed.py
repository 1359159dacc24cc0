"""Where files are when the package is by itself: as in a wheel, whose tree is made up here."""

from pathlib import Path

import pytest
from quiesce.base import paths
from quiesce.base.errors import UsageError
from quiesce.base.extras import extra
from quiesce.cli.main import with_shipped
from quiesce.engine.bench import bench_file


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "site/quiesce/tree"
    (folder / "sim_hil/data/plants").mkdir(parents=True)
    (folder / "sim_hil/data/plants/one.toml").write_text("")
    monkeypatch.setattr(paths, "INSTALLED", folder)
    monkeypatch.delenv("QUIESCE_ROOT", raising=False)
    monkeypatch.delenv("QUIESCE_BUILD", raising=False)
    monkeypatch.chdir(tmp_path)
    return folder


def test_a_checkout_is_not_installed() -> None:
    assert not paths.is_installed()
    assert paths.results_folder() == paths.build_folder()
    assert paths.typed("quiesce rules check") == "./tools/quiesce rules check"
    assert paths.typed("quiesce hil") == "./tools/hil"


def test_what_ships_and_what_is_compiled_is_in_the_package(tree: Path) -> None:
    assert paths.root() == tree
    assert paths.build_folder() == tree / "build"


def test_results_go_to_the_callers_folder(tree: Path) -> None:
    assert paths.results_folder() == Path("quiesce-out")
    assert paths.results_text("replay/NAME") == "quiesce-out/replay/NAME"
    assert paths.typed("quiesce hil --quick") == "quiesce hil --quick"


def test_what_is_kept_goes_to_the_users_cache(
    tree: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "kept"))
    assert paths.cache_folder() == tmp_path / "kept/quiesce"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert paths.cache_folder() == tmp_path / ".cache/quiesce"


def test_a_project_that_is_named_wins(
    tree: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine/sim_hil/data").mkdir(parents=True)
    monkeypatch.setenv("QUIESCE_ROOT", str(tmp_path / "mine"))
    assert paths.root() == tmp_path / "mine"
    assert not paths.is_installed()
    monkeypatch.setenv("QUIESCE_ROOT", str(tmp_path))
    with pytest.raises(UsageError, match="set QUIESCE_ROOT"):
        paths.root()


def test_files_that_ship_are_found_from_anywhere(tree: Path, tmp_path: Path) -> None:
    name = "sim_hil/data/plants/one.toml"
    assert with_shipped(name) == str(tree / name)
    assert with_shipped("sim_hil/data/plants/two.toml") == "sim_hil/data/plants/two.toml"
    assert with_shipped("--plant") == "--plant"
    (tmp_path / name).parent.mkdir(parents=True)
    (tmp_path / name).write_text("of the caller")
    assert with_shipped(name) == name


def test_what_is_not_inside_is_told_without_a_script_of_a_checkout(tree: Path) -> None:
    with pytest.raises(UsageError, match="no part of this package") as caught:
        bench_file()
    assert "./tools" not in str(caught.value)


def test_an_extra_is_asked_for_by_name(tree: Path) -> None:
    with pytest.raises(UsageError, match=r"pip install 'quiesce\[mdf\]'"), extra("mdf", "a file"):
        raise ModuleNotFoundError("none", name="asammdf")
