"""Which column is what: proposed beside the recording, corrected by the user, used from then on."""

from pathlib import Path

import numpy as np
import pytest
from conftest import run_quiesce
from quiesce.base.errors import UsageError
from quiesce.damper.data.read import Columns, read_file
from quiesce.recording.beside import file_beside, stated_beside
from quiesce.signal.recording import read_columns
from quiesce_benchmarks.campaign import written

COLUMNS = written.recording()


def german(folder: Path) -> Path:
    written.german_csv(folder / "rig.csv", COLUMNS)
    return folder / "rig.csv"


def refusal(file: Path) -> str:
    with pytest.raises(UsageError) as refused:
        read_file(file, Columns())
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_german_names_are_proposed_once_and_used_then(tmp_path: Path) -> None:
    file = german(tmp_path)
    line = refusal(file)
    assert "or correct" in line and "rig.csv.columns.toml, which now has a proposal" in line
    text = file_beside(file).read_text()
    for line in (
        'time = "Zeit [s]:s"', 'displacement = "Weg (mm):mm"', 'force = "Kraft in N:N"',
        'current = "Strom/A:A"',
    ):  # fmt: skip
        assert line in text.splitlines()
    (test,) = read_file(file, Columns()).tests
    assert np.allclose(test.si["displacement"], 1e-3 * COLUMNS["displacement"], atol=1e-8)
    assert np.allclose(test.si["force"], COLUMNS["force"], atol=1e-6)


def test_the_users_file_is_kept_and_its_factor_counts(tmp_path: Path) -> None:
    file = german(tmp_path)
    refusal(file)
    place = file_beside(file)
    place.write_text(place.read_text().replace("Kraft in N:N", "Kraft in N:2*kN"))
    (test,) = read_file(file, Columns()).tests
    assert np.allclose(test.si["force"], 2000.0 * COLUMNS["force"], atol=1e-2)
    assert "2*kN" in place.read_text()


def test_names_with_a_unit_are_found_through_it_by_every_command(tmp_path: Path) -> None:
    rows = "\n".join(f"{t:.3f};{a:.4f}".replace(".", ",") for t, a in np.random.rand(9, 2) + 1)
    (tmp_path / "a.csv").write_text(f"Zeit in s;Beschleunigung [g]\n{rows}\n")
    with pytest.raises(UsageError, match="a.csv.columns.toml, which now has a proposal"):
        read_columns(tmp_path / "a.csv", ["t_s", "accel_m_s2"])
    _, cells = read_columns(tmp_path / "a.csv", ["t_s", "accel_m_s2", "Beschleunigung [g]"])
    assert np.allclose(cells[:, 1], 9.80665 * cells[:, 2])


def test_a_unit_that_is_open_is_asked_for(tmp_path: Path) -> None:
    text = german(tmp_path).read_text().replace("Kraft in N", "Kraft")
    (tmp_path / "rig.csv").write_text(text)
    refusal(tmp_path / "rig.csv")
    assert "force: the unit of 'Kraft' is open; write one of N, kN" in refusal(tmp_path / "rig.csv")


def test_a_second_column_for_a_role_is_a_comment(tmp_path: Path) -> None:
    lines = german(tmp_path).read_text().splitlines()
    wide = [lines[0] + ";Kraft 2 [kN];Notiz", *(f"{line};1,0;2,0" for line in lines[1:])]
    (tmp_path / "rig.csv").write_text("\n".join(wide) + "\n")
    refusal(tmp_path / "rig.csv")
    text = file_beside(tmp_path / "rig.csv").read_text()
    assert '# or: force = "Kraft 2 [kN]:kN"' in text and '# not understood: "Notiz"' in text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[columns", "repair or delete it"),
        ("flip_force = true", "one table, [columns]"),
        ("columns = 3", "columns has to be a table"),
        ('[columns]\nweight = "Kraft in N:N"', "no role 'weight'; known are"),
        ('[columns]\nforce = "Kraft in N:mm"', "'mm' is no unit of force"),
        ('[columns]\nforce = "Kraft:N"', "no column is named 'Kraft'; there are: Zeit [s]"),
        ('[columns]\nforce = 3', "force has to be"),
    ],
)  # fmt: skip
def test_a_file_that_is_wrong_is_refused_and_kept(tmp_path: Path, text: str, words: str) -> None:
    file = german(tmp_path)
    file_beside(file).write_text(text)
    assert words in refusal(file)
    assert file_beside(file).read_text() == text


def test_nothing_is_proposed_for_columns_that_are_named_by_options(tmp_path: Path) -> None:
    result = run_quiesce(tmp_path, "identify", german(tmp_path), "--force", "Krft:N")
    assert result.returncode == 2 and "no column is named 'Krft'" in result.stderr
    assert not file_beside(tmp_path / "rig.csv").exists()


def test_without_such_a_file_nothing_is_stated(tmp_path: Path) -> None:
    assert stated_beside(tmp_path / "rig.csv") == {}
