"""The example recording is what it says, and identification takes it as it is."""

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from damper_actions import act, refused
from damper_files import read
from quiesce.base.errors import UsageError
from quiesce.cli.identify import example
from quiesce.damper.data.split import whole
from quiesce.damper.example import EXAMPLE, Recipe, example_columns, example_text, write_example
from quiesce.damper.score import score
from quiesce.damper.simulate import simulator, simulator_of_file

pytestmark = pytest.mark.usefixtures("build")


def test_example_is_read_without_an_option(tmp_path: Path) -> None:
    write_example(tmp_path / "example.csv")
    found = read(tmp_path / "example.csv")
    assert len(found.records) == 1
    record = found.records[0]
    assert (record.rate_Hz, record.command_unit) == (pytest.approx(200.0), "A")
    assert np.unique(np.round(record.command, 3)).tolist() == [0.0, 0.5, 1.0]


def test_truth_explains_the_example_down_to_its_noise(tmp_path: Path) -> None:
    write_example(tmp_path / "example.csv")
    damper, simulate = simulator_of_file(tmp_path / "example_truth.toml")
    assert damper.parameters == EXAMPLE.parameters
    record = read(tmp_path / "example.csv").records[0]
    assert score(simulate, [whole(record)]).error == pytest.approx(0.01, rel=0.1)


def test_example_is_the_same_every_time_and_small() -> None:
    text = example_text()
    assert text == example_text()
    assert len(text) < 300_000
    assert text != example_text(Recipe(seed=7))


def test_shipped_example_is_what_the_library_makes() -> None:
    folder = ROOT / "sim_hil/data/dampers/example"
    shipped = np.loadtxt(folder / "example.csv", delimiter=",", skiprows=1)
    made = np.column_stack(list(example_columns().values()))
    # Printed to 0.01 N, 0.001 mm.
    assert np.abs(shipped - made).max(axis=0) == pytest.approx(np.zeros(4), abs=0.011)
    assert (folder / "example_truth.toml").read_text(encoding="utf-8") == EXAMPLE.to_toml()


def test_noise_and_rounding_are_those_of_the_recipe() -> None:
    clean = example_columns(Recipe(noise_part=0.0))
    noisy = example_columns(Recipe(noise_part=0.05))
    size = np.sqrt(np.mean(clean["force_N"] ** 2))
    assert np.std(noisy["force_N"] - clean["force_N"]) == pytest.approx(0.05 * size, rel=0.05)
    coarse = example_columns(Recipe(resolution_m=1e-4))["disp_mm"]
    assert np.abs(coarse / 0.1 - np.round(coarse / 0.1)).max() < 1e-9


def test_example_absorbs_energy_at_every_current(tmp_path: Path) -> None:
    write_example(tmp_path / "example.csv")
    record = read(tmp_path / "example.csv").records[0]
    for level_A in (0.0, 0.5, 1.0):
        rows = np.isclose(record.command, level_A)
        assert np.sum(record.force_N[rows] * record.velocity_m_s[rows]) > 0.0
    assert np.isfinite(simulator(EXAMPLE)(record)).all()


def test_command_writes_recording_and_truth(tmp_path: Path, capsys) -> None:
    assert act(example, "--out", tmp_path / "new/mine.csv") == 0
    assert sorted(file.name for file in (tmp_path / "new").iterdir()) == [
        "mine.csv", "mine_truth.toml",
    ]  # fmt: skip
    assert "quiesce identify" in capsys.readouterr().out


def test_other_endings_and_folders_in_the_way_are_refused(tmp_path: Path) -> None:
    assert "FILE.csv" in refused(example, "--out", tmp_path / "example.xlsx")
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises((UsageError, OSError)):
        act(example, "--out", tmp_path / "file/example.csv")
