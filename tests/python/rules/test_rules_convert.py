"""Smooth membership functions as chains of straight segments, and `quiesce rules convert`."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import run_quiesce
from quiesce.base.errors import UsageError
from quiesce.rules.formats.files import read_text
from quiesce.rules.model import (
    RuleBase,
)
from rule_files import FCL, FIS, TANK, TEXTS

# Smooth shapes

SMOOTH_FIS = FIS.replace("'linzmf',[0 5]", "'gaussmf',[2 3]")


def noted_error(base: RuleBase) -> float:
    return float(re.search(r"low: gaussmf.*largest error ([\d.e-]+)", " ".join(base.notes))[1])


def true_error(base: RuleBase) -> float:
    x = np.linspace(0, 10, 4001)
    found = np.array([base.inputs[0].sets[0].membership(at) for at in x.tolist()])
    return float(np.abs(found - np.exp(-((x - 3) ** 2) / 8)).max())


@pytest.mark.parametrize("segments", [2, 3, 5, 8, 32, 128])
def test_chain_keeps_the_error_that_it_states(segments: int) -> None:
    base = read_text(SMOOTH_FIS, "fis", "tank", approximate=segments)
    assert len(base.inputs[0].sets[0].points) <= segments + 1
    assert true_error(base) == pytest.approx(noted_error(base), rel=0.06)


def test_more_segments_come_closer() -> None:
    errors = [true_error(read_text(SMOOTH_FIS, "fis", "t", n)) for n in (2, 4, 8, 16, 64)]
    assert errors == sorted(errors, reverse=True)
    assert errors[2] < 0.03 and errors[4] < 5e-4


def two_gaussians(x: float) -> float:
    left = math.exp(-0.5 * (x - 2) ** 2) if x < 2 else 1.0
    return left * (math.exp(-0.5 * ((x - 5) / 2) ** 2) if x > 5 else 1.0)


def spline(t: float) -> float:
    t = min(max(t, 0.0), 1.0)
    return 2 * t * t if t < 0.5 else 1 - 2 * (1 - t) ** 2


def logistic(x: float) -> float:
    return 1 / (1 + math.exp(-x))


SMOOTH = [
    ("fis", "'gauss2mf',[1 2 2 5]", two_gaussians),
    ("fis", "'gbellmf',[2 3 4]", lambda x: 1 / (1 + abs((x - 4) / 2) ** 6)),
    ("fis", "'sigmf',[2 4]", lambda x: logistic(2 * (x - 4))),
    ("fis", "'dsigmf',[3 2 4 7]", lambda x: abs(logistic(3 * (x - 2)) - logistic(4 * (x - 7)))),
    ("fis", "'psigmf',[3 2 -4 7]", lambda x: logistic(3 * (x - 2)) * logistic(-4 * (x - 7))),
    ("fis", "'smf',[1 6]", lambda x: spline((x - 1) / 5)),
    ("fis", "'zmf',[1 6]", lambda x: 1 - spline((x - 1) / 5)),
    ("fis", "'pimf',[1 3 5 9]", lambda x: spline((x - 1) / 2) * (1 - spline((x - 5) / 4))),
    ("fll", "Gaussian 3 2", lambda x: math.exp(-((x - 3) ** 2) / 8)),
    ("fll", "Gaussian 3 2 0.5", lambda x: 0.5 * math.exp(-((x - 3) ** 2) / 8)),
    ("fll", "GaussianProduct 2 1 5 2", two_gaussians),
    ("fll", "Bell 4 2 3", lambda x: 1 / (1 + abs((x - 4) / 2) ** 6)),
    ("fll", "Sigmoid 4 2", lambda x: logistic(2 * (x - 4))),
    (
        "fll",
        "SigmoidDifference 2 3 4 7",
        lambda x: abs(logistic(3 * (x - 2)) - logistic(4 * (x - 7))),
    ),
    ("fll", "SigmoidProduct 2 3 -4 7", lambda x: logistic(3 * (x - 2)) * logistic(-4 * (x - 7))),
    ("fll", "SShape 1 6", lambda x: spline((x - 1) / 5)),
    ("fll", "ZShape 1 6", lambda x: 1 - spline((x - 1) / 5)),
    ("fll", "PiShape 1 3 5 9", lambda x: spline((x - 1) / 2) * (1 - spline((x - 5) / 4))),
    ("fll", "Cosine 5 6", lambda x: 0.5 + 0.5 * math.cos(math.pi / 3 * min(max(x - 5, -3), 3))),
    ("fll", "Spike 5 4", lambda x: math.exp(-abs(2.5 * (x - 5)))),
    ("fll", "Concave 3 7", lambda x: 4 / (4 + max(7 - x, 0))),
    ("fll", "Concave 7 3", lambda x: 4 / (4 + max(x - 3, 0))),
    ("fcl", "gauss 3 2", lambda x: math.exp(-((x - 3) ** 2) / 8)),
    ("fcl", "gauss2 2 1 5 2", two_gaussians),
    ("fcl", "gbell 2 3 4", lambda x: 1 / (1 + abs((x - 4) / 2) ** 6)),
    ("fcl", "sigm 2 4", lambda x: logistic(2 * (x - 4))),
    ("fcl", "dsigm 3 2 4 7", lambda x: abs(logistic(3 * (x - 2)) - logistic(4 * (x - 7)))),
]
STRAIGHT = {"fcl": "(0, 1) (5, 0)", "fll": "Ramp 5.000 0.000", "fis": "'linzmf',[0 5]"}


@pytest.mark.slow
@pytest.mark.parametrize(("format", "shape", "value"), SMOOTH)
def test_smooth_shape_is_its_formula(format: str, shape: str, value) -> None:
    text = TEXTS[format].replace(STRAIGHT[format], shape)
    with pytest.raises(UsageError, match="--approximate N"):
        read_text(text, format, "tank")
    base = read_text(text, format, "tank", approximate=128)
    for x in np.linspace(0, 10, 401).tolist():
        assert base.inputs[0].sets[0].membership(x) == pytest.approx(value(x), abs=1.5e-3)


# The command


def test_convert_prints_and_writes_the_same(tmp_path: Path) -> None:
    (tmp_path / "tank.fis").write_text(FIS)
    printed = run_quiesce(tmp_path, "rules", "convert", "tank.fis", "--to", "fcl")
    assert printed.returncode == 0, printed.stderr
    assert read_text(printed.stdout, "fcl", "x") == TANK
    assert "tank.fis: output valve: where no rule fires 0.5" in printed.stderr
    written = run_quiesce(
        tmp_path, "rules", "convert", "tank.fis", "--to", "fcl", "--out", "new/tank.fcl"
    )
    assert (written.returncode, written.stdout) == (0, "")
    assert (tmp_path / "new/tank.fcl").read_text() == printed.stdout


def test_convert_tells_the_error_of_each_smooth_set(tmp_path: Path) -> None:
    (tmp_path / "tank.fis").write_text(SMOOTH_FIS)
    result = run_quiesce(
        tmp_path, "rules", "convert", "tank.fis", "--to", "fll", "--approximate", "8"
    )
    assert result.returncode == 0
    assert re.search(
        r"input level, set low: gaussmf as a chain of 8 segments, largest error 0\.0", result.stderr
    )
    assert "Discrete" in result.stdout


def test_convert_says_that_smooth_sets_stay_smooth(tmp_path: Path) -> None:
    (tmp_path / "smooth.fis").write_text(SMOOTH_FIS)
    result = run_quiesce(tmp_path, "rules", "convert", "smooth.fis", "--to", "fcl")
    assert result.returncode == 0 and "Gaussian" in result.stdout
    first = result.stderr.splitlines()[0]
    assert first.startswith("written as it is, as smooth.fis:18:11: ")
    assert "--approximate N" in first


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["tank.fis", "--to", "fcl", "--out", "tank.fll"], ["tank.fll", ".fcl"]),
        (["tank.fis", "--to", "fcl", "--approximate", "1"], ["--approximate 1", "2 to 128"]),
        (["tank.fis", "--to", "toml"], ["toml", "fcl"]),
        (["tank.txt", "--to", "fcl"], ["tank.txt", ".fcl, .fll, .fis"]),
        (["none.fis", "--to", "fcl"], ["none.fis", "No such file"]),
        (["folder.fis", "--to", "fcl"], ["folder.fis", "directory"]),
        (["named.fis", "--to", "fcl", "--out", "new.fcl"], ["'low level'", "FCL names"]),
        (["max.fcl", "--to", "fis", "--out", "new.fis"], ["greatest strength"]),
    ],
)
def test_convert_refuses_in_one_line_and_writes_nothing(tmp_path: Path, arguments, words) -> None:
    (tmp_path / "tank.fis").write_text(FIS)
    (tmp_path / "smooth.fis").write_text(SMOOTH_FIS)
    (tmp_path / "named.fis").write_text(SMOOTH_FIS.replace("'low'", "'low level'"))
    (tmp_path / "max.fcl").write_text(FCL.replace("SUM", "MAX"))
    (tmp_path / "folder.fis").mkdir()
    before = sorted(tmp_path.iterdir())
    result = run_quiesce(tmp_path, "rules", "convert", *arguments)
    assert (result.returncode, result.stdout) == (2, "")
    assert len(result.stderr.splitlines()) == 1
    for word in words:
        assert word in result.stderr
    assert sorted(tmp_path.iterdir()) == before
