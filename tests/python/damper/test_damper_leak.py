"""Held-out rows must not reach a fit, a choice or a model file."""

import json
from pathlib import Path

import numpy as np
import pytest
from quiesce.cli.main import main
from test_damper_identify import write_example

pytestmark = pytest.mark.slow  # several fits


def test_forces_of_test_rows_change_nothing_but_the_test_error(tmp_path: Path) -> None:
    """Two files that differ in held-out forces only give the same models, bit by bit."""
    plain = tmp_path / "plain.csv"
    write_example(plain, rows=1200)
    head, *rows = plain.read_text(encoding="utf-8").splitlines()
    cells = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    cells[cells[:, 0] >= 3.0, 2] *= 5.0
    other = tmp_path / "other"
    other.mkdir()
    lines = [f"{t:.4f},{x:.6f},{f:.4f}" for t, x, f in cells]
    (other / "plain.csv").write_text("\n".join([head, *lines]) + "\n", encoding="utf-8")
    found = []
    for file in (plain, other / "plain.csv"):
        out = file.parent / "out"
        words = ["identify", str(file), "--current-a", "0", "--effort", "quick", "--out", str(out)]
        words += ["--train", "time_s=0,3", "--test", "time_s=3,6"]
        words += ["--model", "kwok_tanh,viscoplastic_1,anfis,feed_forward_network"]
        assert main(words) == 0
        models = {one.name: one.read_bytes() for one in sorted((out / "models").glob("*.toml"))}
        report = json.loads((out / "report.json").read_text(encoding="utf-8"))
        errors = {one["name"]: one["test"]["error"] for one in report["models"]}
        found.append((models, report["winners"], errors))
    assert len(found[0][0]) == 4
    assert found[0][0] == found[1][0] and found[0][1] == found[1][1]
    assert all(found[0][2][name] != found[1][2][name] for name in found[0][2])
