"""Scenario files made for a sweep: steady vibration at given frequencies and drive voltages."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import default_plant
from quiesce.engine import scenarios
from quiesce.engine.bench import Bench
from quiesce.engine.scenarios import SCHEMA, Scenario

SETTLE_s, MAX_SETTLE_s, MEASURE_s = 6, 600, 2
NOISE_mg = 0.5


@dataclass(frozen=True)
class Steadies:
    """Steady vibration of one plant at every frequency and drive."""

    plant: Path
    freqs_Hz: Sequence[float]
    drives_V: Sequence[float | None]  # None: the plant's
    settle_s: int


def plant_file(name: str | None) -> Path:
    return Path(name).resolve() if name else default_plant()


def toml_text(text: object) -> str:
    return str(text).replace("\\", "\\\\").replace('"', '\\"')


def steady_text(
    name: str, plant: Path, freq_Hz: float, drive_V: float | None, settle_s: int
) -> str:
    """A steady sine from rest; measured over 2 s after settle_s."""
    drive = "" if drive_V is None else f"drive_V = {drive_V!r}\n"
    return (
        f'schema = "{SCHEMA}"\nversion = 1\nname = "{name}"\nplant = "{toml_text(plant)}"\n'
        f"duration_s = {settle_s + MEASURE_s}\nnoise_mg = {NOISE_mg}\n{drive}"
        f'\n[[segment]]\nkind = "sine"\nfreq_Hz = {freq_Hz!r}\n'
        f"\n[[window]]\nstart_s = {settle_s}\nend_s = {settle_s + MEASURE_s}\n"
    )


def steady_scenarios(
    bench: Bench,
    folder: Path,
    plant: Path,
    freqs_Hz: Sequence[float],
    drives_V: Sequence[float | None],
    settle_s: int = SETTLE_s,
) -> list[Scenario]:
    """One scenario for every frequency and drive, in files of `folder`. None: the plant's drive."""
    check_plant(bench, plant)
    found = []
    for drive_V in drives_V:
        for freq_Hz in freqs_Hz:
            name = f"{freq_Hz:g} Hz" + ("" if drive_V is None else f" {drive_V:g} V")
            file = folder / f"{name.replace(' ', '_')}.toml"
            text = steady_text(name, plant, freq_Hz, drive_V, settle_s)
            file.write_text(text, encoding="utf-8")
            found.append(scenarios.load(bench, str(file)))
    return found


def check_plant(bench: Bench, plant: Path) -> None:
    try:
        bench.call("plant-check", str(plant))
    except UsageError as error:
        raise UsageError(f"--plant: {one_line(error)}")
