"""A structure's matrices, from its plant file or from CSV files beside it."""

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.base.matrix_file import KEYS, read_matrix
from quiesce.law.structure import load_structure
from quiesce.plant.variant import read_plant_data

PLANTS = ROOT / "sim_hil/data/plants"
FIVE = PLANTS / "five_storeys.toml"


def test_matrices_of_files_are_those_of_the_plant() -> None:
    found = load_structure(FIVE, ["first", "roof"], ["brace"])
    assert found.mass == pytest.approx(50.0 * np.eye(5))
    assert found.stiffness == pytest.approx(found.stiffness.T)
    assert found.dampers.tolist() == [[1, 0, 0, 0, 0]]
    assert found.bodies_base.tolist() == [1, 1]
    w2 = np.linalg.eigvalsh(found.stiffness / 50.0)
    assert np.sqrt(w2[0]) / (2 * np.pi) == pytest.approx(2.668, abs=0.001)


def test_a_copy_of_a_plant_holds_them_itself(tmp_path: Path) -> None:
    text = FIVE.read_text().replace('[[damper]]\nname = "brace"\na = "first"\nb = "ground"\n',
                                    "[damper]\n")  # fmt: skip
    for key in KEYS:
        name = f"five_storeys/{key.split('_')[0]}.csv"
        text = text.replace(name, str(PLANTS / name))
    file = tmp_path / "plant.toml"
    file.write_text(text.replace("force = ", "damper = [1, 0, 0, 0, 0]\nforce = ", 1))
    structure = read_plant_data(file)["structure"]
    assert not any(key.endswith("_file") for key in structure)
    assert np.array(structure["mass_kg"]).shape == (5, 5)


@pytest.mark.parametrize("text", ["1,x\n", "1,,2\n", "1;2\n"])
def test_what_is_no_matrix_is_one_line(tmp_path: Path, text: str) -> None:
    file = tmp_path / "m.csv"
    file.write_text(text)
    with pytest.raises(UsageError, match="expected lines of numbers"):
        read_matrix(file)
    with pytest.raises(UsageError, match="name a CSV file"):
        read_matrix(tmp_path / "none.csv")
