"""FMUs that several tests run, packed once."""

from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import ROOT, require, run_quiesce

PLANT = ROOT / "sim_hil/data/plants/squeeze_2012.toml"
SCENARIO = ROOT / "sim_hil/data/scenarios/sine_10Hz.toml"
DAMPER = ROOT / "sim_hil/data/dampers/rd8040_kwok_tanh.toml"
# Of each kind: arguments of `quiesce fmu`.
KINDS = {
    "controller": ("controller", "--law", "phase", "--plant", PLANT),
    "constant": ("controller", "--law", "constant"),
    "plant": ("plant", "--scenario", SCENARIO),
    "pushed": ("plant", PLANT),
    "damper": ("damper", DAMPER),
}


@pytest.fixture(scope="session")
def fmu(tmp_path_factory: pytest.TempPathFactory, build: Path) -> Callable[[str, str], Path]:
    """fmu(KIND, VERSION): the file."""
    require(build / "host/targets/fmu/libquiesce_fmu.so")
    folder = tmp_path_factory.mktemp("fmu")

    def made(kind: str, version: str) -> Path:
        file = folder / f"{kind}_{version}.fmu"
        if not file.exists():
            result = run_quiesce(folder, "fmu", *KINDS[kind], "--fmi", version, "-o", file.name)
            assert result.returncode == 0, result.stderr
        return file

    return made
