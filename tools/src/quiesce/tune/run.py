"""The whole of `quiesce tune`: plant, work, law, what it is worth, files."""

import hashlib
import json
import shlex
import tempfile
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import results_folder, shown, typed
from quiesce.engine.bench import Bench
from quiesce.engine.params import effective_params
from quiesce.optimum.store import plant_hash
from quiesce.plant.library import Plant
from quiesce.plant.variant import read_plant_data
from quiesce.plant_id.find import PLANT_NAME, find_plant
from quiesce.report.plot_style import svg_of
from quiesce.table.file import SUFFIX, table_bytes
from quiesce.tune import plots
from quiesce.tune.cycle import Cycle, cycles
from quiesce.tune.law import file_stem, make_law, parameters, results, rows, setting_words
from quiesce.tune.narrow import narrow_parameters
from quiesce.tune.page import Tuned, make_page, text
from quiesce.tune.phase_table import PhaseLaw, law_text
from quiesce.tune.phase_words import law_words
from quiesce.tune.plan import Band, TunePlan, chosen_settings, make_plan
from quiesce.tune.robust import Cell, ClosedLoop, cells
from quiesce.tune.setting import Setting
from quiesce.tune.store import TuneStore
from quiesce.tune.work import compute_plan, fronts

__all__ = ["Band", "Order", "Source", "chosen_settings", "tune"]

MOST_A = 20.0  # that the controller's parameters allow
IDENTIFIED = "identified"
SOURCE_NAME = "source.json"


@dataclass(frozen=True)
class Source:
    """A plant file, or a recording with what it cannot tell."""

    plant: Path | None
    recording: Path | None
    base_plant: Path | None
    modal_mass_kg: float
    is_damper_at_sensor: bool
    mode_count: int | None

    def fingerprint(self) -> dict[str, Any]:
        """Of an identification."""
        assert self.recording is not None
        facts = {key: str(value) for key, value in asdict(self).items()}
        base = self.base_plant.read_bytes() if self.base_plant else b""
        digest = hashlib.sha256(self.recording.read_bytes() + base)
        return {**facts, "content": digest.hexdigest()}


@dataclass(frozen=True)
class Order:
    """What the user asked for."""

    source: Source
    out: Path | None
    asked: str  # as it can be typed again, but for `out`
    band: Band
    settings: dict[str, Setting]
    robustness: str
    is_quick: bool
    is_fresh: bool
    has_closed_loop: bool
    jobs: int


@dataclass(frozen=True)
class Result:
    """A finished tuning. Files are in `folder`."""

    tuned: Tuned
    folder: Path
    names: list[str]

    def text(self) -> str:
        files = ", ".join(self.names)
        return f"{text(self.tuned)}\nwritten    {shown(self.folder)}: {files}"

    def json(self) -> dict[str, Any]:
        return {**figures_json(self.tuned), "folder": str(self.folder), "files": self.names}


def tune(order: Order) -> Result:
    """UsageError for what cannot be tuned; nothing is written then, but finished pieces."""
    if order.has_closed_loop:
        Bench()
    plant_file, report = found_plant(order)
    plant = Plant(plant_file)
    if plant.max_current_A > MOST_A:
        raise UsageError(f"{shown(plant_file)}: driver.max_current_A: the controller commands at "
                         f"most {MOST_A:g} A")  # fmt: skip
    plan = make_plan(plant, order.band, order.settings, order.robustness, order.is_quick)
    data = read_plant_data(plant_file)
    folder = order.out or default_folder(order.source, data["name"])
    inputs = {"plant": f"{plant_hash(data)} {plant.drive_V:g} V", **plan.inputs()}
    with closing(TuneStore(folder, inputs, order.is_fresh)) as store:
        compute_plan(store, plan, order.jobs)
        return finished(order, plan, plant, store, folder, data["name"], report)


def default_folder(source: Source, name: str) -> Path:
    stem = source.recording.stem if source.recording else name
    return results_folder() / "tune" / file_stem(stem)


def found_plant(order: Order) -> tuple[Path, str | None]:
    """The plant's file and, where it was identified, the report of that."""
    source = order.source
    if source.plant is not None:
        return source.plant, None
    assert source.recording is not None
    if not source.recording.is_file():
        raise UsageError(f"{shown(source.recording)}: no such file; name a recording")
    folder = (order.out or default_folder(source, "")) / IDENTIFIED
    fingerprint = source.fingerprint()
    if order.is_fresh or not was_identified(folder, fingerprint):
        find_plant(
            source.recording, folder, source.base_plant, source.modal_mass_kg,
            source.is_damper_at_sensor, source.mode_count,
        )  # fmt: skip
        (folder / SOURCE_NAME).write_text(json.dumps(fingerprint, indent=1), encoding="utf-8")
    return folder / PLANT_NAME, (folder / "report.txt").read_text(encoding="utf-8")


def was_identified(folder: Path, fingerprint: dict[str, Any]) -> bool:
    """Already, from the same recording."""
    try:
        return json.loads((folder / SOURCE_NAME).read_text(encoding="utf-8")) == fingerprint
    except (OSError, ValueError):
        return False


def finished(
    order: Order, plan: TunePlan, plant: Plant, store: TuneStore,
    folder: Path, name: str, report: str | None,
) -> Result:  # fmt: skip
    law = make_law(plant, plan, store, name, order.asked)
    found = results(plan, store)
    narrow = narrow_parameters(plan.freqs_Hz, found, law.unlock_current_mA)
    values = parameters(plant, law) | narrow
    judged, shown_cycles = closed_loop(order, plan, plant, store, law, values)
    tuned = Tuned(
        name, shown(plant.file), command(order), plant.modes[0].freq_Hz,
        rows(plant, plan, store, law), judged, shown_cycles, values, report,
    )  # fmt: skip
    found_fronts = {work.freq_Hz: store[work.key] for work in fronts(plan)}
    with output_files(folder) as staging:
        write_law_files(staging, file_stem(name), law, values)
        write_report(staging, tuned, law, found_fronts)
        names = sorted(file.name for file in staging.iterdir())
    return Result(tuned, folder, names)


def command(order: Order) -> str:
    out = shlex.join(["--out", shown(order.out)]) if order.out else ""
    return typed(f"{order.asked} {out}".rstrip())


def closed_loop(
    order: Order, plan: TunePlan, plant: Plant, store: TuneStore,
    law: PhaseLaw, values: dict[str, int | str],
) -> tuple[list[Cell], list[Cycle]]:  # fmt: skip
    """Other plants, and a cycle below and above resonance."""
    if not order.has_closed_loop:
        return cells(plan, store, law, None), []
    settings = [f"{name}={value}" for name, value in values.items() if name != "law"]
    with tempfile.TemporaryDirectory(prefix="quiesce-") as scratch:
        loop = ClosedLoop(law, settings, Path(scratch))
        effective_params(loop.bench, settings)
        return cells(plan, store, law, loop), cycles(plan, plant, law, loop)


def write_law_files(folder: Path, stem: str, law: PhaseLaw, values: dict[str, int | str]) -> None:
    (folder / f"{stem}.phase.toml").write_text(law_text(law), encoding="utf-8")
    (folder / f"{stem}.phase{SUFFIX}").write_bytes(table_bytes(law_words(law)))
    (folder / f"{stem}.set").write_text(setting_words(values) + "\n", encoding="utf-8")


def write_report(
    folder: Path, tuned: Tuned, law: PhaseLaw, fronts: dict[float, list[dict[str, float]]]
) -> None:
    figures = {
        "reductions": plots.plot_reductions(tuned.rows),
        "pulses": plots.plot_pulses(law),
        "fronts": plots.plot_fronts(tuned.rows, fronts),
    }
    if tuned.cycles:
        figures["cycles"] = plots.plot_cycles(tuned.cycles, tuned.first_Hz)
    if tuned.cells:
        figures["robustness"] = plots.plot_robustness(tuned.cells)
    pictures = {name: svg_of(figure) for name, figure in figures.items()}
    for name, picture in pictures.items():
        (folder / f"{name}.svg").write_text(picture, encoding="utf-8")
    (folder / "report.html").write_text(make_page(tuned, pictures), encoding="utf-8")
    data = {**figures_json(tuned), "fronts": {f"{f:g}": front for f, front in fronts.items()}}
    (folder / "tune.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


def figures_json(tuned: Tuned) -> dict[str, Any]:
    return {
        "name": tuned.name,
        "plant": tuned.plant,
        "command": tuned.command,
        "parameters": tuned.parameters,
        "frequencies": [asdict(row) for row in tuned.rows],
        "robustness": [{**asdict(cell), "variant": cell.variant.name} for cell in tuned.cells],
        "cycles": [
            {"freq_Hz": one.freq_Hz, "setting": one.setting,
             "stiffness_N_m": one.stiffness_N_m, "damping_N_s_m": one.damping_N_s_m}
            for one in tuned.cycles
        ],
        "identification": tuned.identification,
    }  # fmt: skip
