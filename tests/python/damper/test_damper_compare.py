"""A model file against new data: errors, energy, and hints that are not applied."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from damper_actions import act, dissipative_tanh, refused, two_tones, write
from quiesce.cli.identify import compare as cli_compare
from quiesce.damper import library
from quiesce.damper.compare import Comparison, compare
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import whole
from quiesce.damper.example import EXAMPLE, write_example
from quiesce.damper.library import DamperFile
from quiesce.damper.model_file import DamperModel
from quiesce.damper.report.runs import cycle_energies_J, runs_of
from quiesce.damper.simulate import simulator, simulator_of_file, with_rig

pytestmark = pytest.mark.usefixtures("build")


def measured(damper: DamperModel, record: Record, noise_N: float = 0.0) -> Record:
    """The record with this damper's force."""
    noise = noise_N * np.random.default_rng(1).standard_normal(len(record))
    return replace(record, force_N=simulator(damper)(record) + noise)


def compared(damper: DamperModel, *records: Record) -> Comparison:
    return compare(damper, runs_of(simulator(damper), [], [whole(one) for one in records]))


def changed(record: Record, force_N: np.ndarray) -> Record:
    return replace(record, force_N=force_N)


def first_hint(found: Comparison) -> str:
    return found.hints[0].what if found.hints else "none"


def test_model_has_no_error_on_its_own_force() -> None:
    found = compared(EXAMPLE, measured(EXAMPLE, two_tones()))
    assert found.score.error <= 1e-12
    assert found.hints == []
    assert found.energy_ratios == pytest.approx([1.0])


def test_noise_gives_its_own_error_and_no_hint() -> None:
    record = measured(EXAMPLE, two_tones(duration_s=6.0))
    size = float(np.sqrt(np.mean(record.force_N**2)))
    found = compared(EXAMPLE, measured(EXAMPLE, two_tones(duration_s=6.0), 0.05 * size))
    assert found.score.error == pytest.approx(0.05, rel=0.1)
    assert found.hints == []


def test_scale_is_offered_with_its_value() -> None:
    record = measured(EXAMPLE, two_tones())
    found = compared(EXAMPLE, changed(record, 1.3 * record.force_N))
    assert first_hint(found) == "scale"
    assert found.hints[0].value == pytest.approx(1.3)
    assert found.hints[0].error <= 1e-9
    assert found.score.error == pytest.approx(0.3 / 1.3)


def test_offset_is_offered_with_its_value() -> None:
    record = measured(EXAMPLE, two_tones())
    found = compared(EXAMPLE, changed(record, record.force_N - 150.0))
    assert first_hint(found) == "offset"
    assert found.hints[0].value == pytest.approx(-150.0)


@pytest.mark.parametrize("rows", [-4, 3])
def test_shift_in_time_is_offered_with_its_value(rows: int) -> None:
    record = measured(EXAMPLE, two_tones())
    found = compared(EXAMPLE, changed(record, np.roll(record.force_N, rows)))
    assert first_hint(found) == "skew"
    assert found.hints[0].value == pytest.approx(rows / record.rate_Hz, abs=3e-4)


def test_turned_sign_is_offered_instead_of_a_negative_scale() -> None:
    record = measured(EXAMPLE, two_tones())
    found = compared(EXAMPLE, changed(record, -record.force_N))
    assert first_hint(found) == "sign"
    assert all(one.what != "scale" for one in found.hints)
    assert "--flip-force" in found.hints[0].text


def test_energy_ratio_is_that_of_the_forces() -> None:
    record = measured(EXAMPLE, two_tones())
    found = compared(EXAMPLE, changed(record, 2.0 * record.force_N))
    assert found.energy_ratios == pytest.approx([0.5], rel=1e-9)


def test_cycle_energy_of_a_viscous_force_is_that_of_the_formula() -> None:
    viscous = dissipative_tanh(c_N_s_m=800.0, alpha_N=0.0)
    w, time_s = 2.0 * np.pi * 2.0, np.arange(4000) / 1000.0
    disp = 0.01 * np.sin(w * time_s - 0.3)
    velocity = 0.01 * w * np.cos(w * time_s - 0.3)
    zero = np.zeros(len(time_s))
    record = Record("sine", 1000.0, time_s, disp, velocity, zero, 800.0 * velocity, zero, "A")
    run = runs_of(simulator(viscous), [], [whole(record)])[0]
    expected_J = np.pi * 800.0 * w * 0.01**2
    assert cycle_energies_J(run) == pytest.approx((expected_J, expected_J), rel=2e-3)


def test_model_that_diverges_is_scored_but_gets_no_hint() -> None:
    record = measured(EXAMPLE, two_tones())
    runs = runs_of(lambda one: np.full(len(one), np.nan), [], [whole(record)])
    found = compare(EXAMPLE, runs)
    assert math.isinf(found.score.error) and found.hints == []


def test_data_beyond_the_models_range_are_told() -> None:
    record = measured(EXAMPLE, two_tones(current_A=3.0))
    slow = replace(EXAMPLE, speed_m_s=0.01, stroke_m=0.001)
    text = " ".join(compared(slow, record).warnings)
    assert "current_A = [0.0, 1.0]" in text and "speeds up to" in text and "travel up to" in text
    unusable = replace(EXAMPLE, valid={"usable": False, "reason": "peaks"})
    assert "peaks" in compared(unusable, record).warnings[0]


def test_models_that_are_no_kernels_get_the_same_rig(tmp_path: Path) -> None:
    """The rig in Python does what the library does around a kernel."""
    rig = {"rise_s": 0.012, "fall_s": 0.03, "inertia_kg": 2.0, "skew_s": 0.001, "offset_N": 20.0}
    damper = replace(dissipative_tanh(), rig=rig | {"drift_N_s": 3.0})
    current_A = np.where(np.arange(2000) // 300 % 2, 1.0, 0.2)
    record = two_tones(1000.0, 2.0, current_A)
    file = write(tmp_path / "damper.toml", damper)
    found = with_rig(DamperFile(file), damper.rig)(record)
    expected = simulator(damper)(record)
    assert np.linalg.norm(found - expected) <= 2e-3 * np.linalg.norm(expected)
    assert simulator_of_file(file)[1](record) == pytest.approx(expected)
    assert set(damper.rig) <= set(library.RIG)


# Command line


@pytest.fixture(scope="module")
def example(build, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("example")
    write_example(folder / "example.csv")
    return folder


def test_command_scores_the_example_at_its_noise(example: Path, capsys) -> None:
    assert act(cli_compare, example / "example_truth.toml", example / "example.csv") == 0
    said = capsys.readouterr().out
    assert "white noise" in said and "Hints" not in said


def test_command_gives_the_same_as_json(example: Path, capsys) -> None:
    files = (example / "example_truth.toml", example / "example.csv")
    assert act(cli_compare, *files, "--json", "--test", "part=0.5,1", "--train", "part=0,0.5") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["error"] == pytest.approx(0.01, rel=0.1)
    assert found["tests"][0]["rows"] == 2400
    assert found["tests"][0]["energy_ratio"] == pytest.approx(1.0, abs=0.01)


def test_command_writes_a_page_that_stands_alone(example: Path, tmp_path: Path, capsys) -> None:
    files = (example / "example_truth.toml", example / "example.csv")
    assert act(cli_compare, *files, "--out", tmp_path / "page") == 0
    page = (tmp_path / "page/compare.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 4
    assert 'src="http' not in page and "<script" not in page


def data(folder: Path, change) -> Path:
    """The example's CSV with its lines changed."""
    text = (folder / "example.csv").read_text(encoding="utf-8")
    out = folder / "changed.csv"
    out.write_text(change(text), encoding="utf-8")
    return out


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda text: text.replace("force_N", "Load_N", 1).replace("Load_N", "q_N"), "force"),
        (lambda text: "\n".join(text.splitlines()[:4]), "rows"),
        (lambda text: "{}" + text, "JSON"),
        (lambda _: "", "empty"),
    ],
)
def test_bad_data_are_refused(example: Path, change, what: str) -> None:
    message = refused(cli_compare, example / "example_truth.toml", data(example, change))
    assert what in message and "changed.csv" in message


def test_not_a_number_names_its_line(example: Path) -> None:
    def spoil(text: str) -> str:
        lines = text.splitlines()
        cells = lines[7].split(",")
        lines[7] = ",".join([cells[0], "nan", *cells[2:]])
        return "\n".join(lines)

    file = data(example, spoil)
    assert "changed.csv:8: " in refused(cli_compare, example / "example_truth.toml", file)


def test_files_in_the_wrong_order_are_told(example: Path) -> None:
    message = refused(cli_compare, example / "example.csv", example / "example_truth.toml")
    assert "comes first" in message


def test_bad_model_files_are_refused(example: Path, tmp_path: Path) -> None:
    recording = example / "example.csv"
    assert "no such file" in refused(cli_compare, tmp_path / "no.toml", recording)
    for text, what in (
        ("not toml", "bad.toml"),
        ('schema = "quiesce-plant"\nversion = 1\n', "bad.toml"),
        (EXAMPLE.to_toml().replace("normalised_bouc_wen", "magic_damper"), "magic_damper"),
        (EXAMPLE.to_toml().replace("sigma = 0.8", "sigma = nan"), "sigma"),
        (EXAMPLE.to_toml().replace("sigma = 0.8", ""), "sigma"),
    ):
        file = tmp_path / "bad.toml"
        file.write_text(text, encoding="utf-8")
        assert what in refused(cli_compare, file, recording)
