"""Published figures, an independent simulation's, and the bound: from reference_squeeze.toml."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.paths import scenario_folder

FILE_NAME = "reference_squeeze.toml"
FREQ_TOLERANCE_Hz = 1e-3


@dataclass(frozen=True)
class Published:
    scenario: str
    law: str
    freq_Hz: float
    low_pct: float  # equals high_pct where the source gives one figure
    high_pct: float
    source: str


@dataclass(frozen=True)
class Reference:
    """Figures for one plant at one drive. Every look-up returns None where there is none."""

    plant_file: Path
    drive_V: float
    published: tuple[Published, ...]
    bounds: dict[float, tuple[float, float]]  # amplitude, RMS acceleration, by frequency
    simulated: tuple[dict[str, Any], ...]

    def covers(self, plant_file: Path, drive_V: float) -> bool:
        return plant_file.resolve() == self.plant_file and abs(drive_V - self.drive_V) < 1e-9

    def bound(self, freq_Hz: float) -> tuple[float, float] | None:
        for known_Hz, figures in self.bounds.items():
            if abs(known_Hz - freq_Hz) < FREQ_TOLERANCE_Hz:
                return figures
        return None

    def published_for(self, scenario: str, law: str, freq_Hz: float) -> Published | None:
        for case in self.published:
            if (case.scenario, case.law) == (scenario, law) and is_near(case.freq_Hz, freq_Hz):
                return case
        return None

    def simulated_for(self, scenario: str, law: str, freq_Hz: float) -> dict[str, float]:
        for case in self.simulated:
            if case["scenario"] == scenario and is_near(case["freq_Hz"], freq_Hz):
                return case.get(law, {})
        return {}


def is_near(one_Hz: float, other_Hz: float) -> bool:
    return abs(one_Hz - other_Hz) < FREQ_TOLERANCE_Hz


def parse_published(case: dict[str, Any]) -> Published:
    figure = case["amp_reduction_pct"]
    low_pct, high_pct = figure if isinstance(figure, list) else (figure, figure)
    return Published(
        case["scenario"], case["law"], float(case["freq_Hz"]), low_pct, high_pct, case["source"]
    )


def load_reference(file: Path | None = None) -> Reference:
    file = file or scenario_folder() / FILE_NAME
    data = tomllib.loads(file.read_text(encoding="utf-8"))
    bound = data["bound"]
    figures = zip(bound["amp_reduction_pct"], bound["accel_rms_reduction_pct"], strict=True)
    return Reference(
        plant_file=(file.parent / data["plant"]).resolve(),
        drive_V=data["drive_V"],
        published=tuple(parse_published(case) for case in data["published"]),
        bounds=dict(zip(map(float, bound["freq_Hz"]), figures, strict=True)),
        simulated=tuple(data["simulated"]),
    )
