"""`./tools/benchmark house`: its counts see what they count, its clock ends at the frame."""

import os
import shlex
import sys
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.base.errors import BenchFailure
from quiesce_benchmarks.house import emergency
from quiesce_benchmarks.house.benchmark import COUNTS, TIMES, figures_of
from quiesce_benchmarks.house.structure import firmware_rig_names, flat_modules
from quiesce_benchmarks.house.timed import run_timed


def write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def test_times_never_fail_a_check_and_counts_do() -> None:
    figures = {figure.name: figure for figure in figures_of({"stop_s": 9.0, "flat_modules": 85})}
    assert len(figures) == len(COUNTS) + len(TIMES)
    assert figures["stop_s"].is_ok is False and not figures["stop_s"].is_gated
    assert figures["flat_modules"].is_ok is False and figures["flat_modules"].is_gated


def test_flat_modules_of_the_project() -> None:
    assert 1 <= flat_modules(ROOT) <= 3


def test_rig_names_are_found_outside_of_plants_only(tmp_path: Path) -> None:
    write(tmp_path / "sim_hil/data/plants/bridge.toml", "")
    write(tmp_path / "firmware/plants/squeeze_2012/rules.h", "squeeze_2012 bridge\n")
    write(tmp_path / "firmware/law/law.c", "// nothing\n")
    assert firmware_rig_names(tmp_path) == 0
    write(tmp_path / "firmware/law/law.c", "int squeeze_2012_a, my_bridge;\n")
    assert firmware_rig_names(tmp_path) == 2
    assert firmware_rig_names(ROOT) == 0


def test_cpu_time_is_of_the_whole_tree(tmp_path: Path) -> None:
    burn = "import time\nwhile time.process_time() < 0.3: pass"
    python = shlex.quote(sys.executable)  # the project's folder may have a space in its name
    script = f"{python} -c '{burn}'; {python} -c '{burn}'; echo end; exit 3"
    done = run_timed(["bash", "-c", script], tmp_path)
    assert done.cpu_s >= 0.6
    assert done.code == 3 and done.last_line == "end"


def test_stop_is_timed_until_its_frame(tmp_path: Path) -> None:
    script = tmp_path / "tools/quiesce"
    # The last word is the bus, slcan:PATH.
    write(
        script,
        '#!/bin/bash\nbus="${@: -1}"\nprintf \'t0201AA\\r\' >"${bus#slcan:}"\nsleep 9\n',
    )
    os.chmod(script, 0o755)
    assert 0.0 < emergency.stop_s(tmp_path) < 9.0


def test_stop_without_a_frame_is_told(tmp_path: Path, monkeypatch) -> None:
    write(tmp_path / "tools/quiesce", "#!/bin/bash\nexit 0\n")
    os.chmod(tmp_path / "tools/quiesce", 0o755)
    monkeypatch.setattr(emergency, "PATIENCE_S", 0.2)
    with pytest.raises(BenchFailure, match="no frame"):
        emergency.stop_s(tmp_path)


def test_locks_of_another_are_told(tmp_path: Path) -> None:
    with (
        emergency.all_locks(tmp_path),
        pytest.raises(BenchFailure, match="building"),
        emergency.all_locks(tmp_path),
    ):
        pass
