"""Measured and modelled forces of every test as files for other programs."""

import re
from collections.abc import Sequence
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.damper.data.split import Segment
from quiesce.damper.fitted import Fitted
from quiesce.damper.report.runs import Run, runs_of
from quiesce.damper.report.tables import winners
from quiesce.damper.simulate import simulator
from quiesce.recording.write import FORMATS, Columns, write_columns

_WRITTEN = re.compile(rf"\d\d+_(train|test)_.*\.({'|'.join(FORMATS)})")
COMMANDS = {"A": "current_A", "V": "voltage_V"}


def write_runs(
    folder: Path,
    fitted: Sequence[Fitted],
    train: Sequence[Segment],
    test: Sequence[Segment],
    ending: str,
) -> list[str]:
    """A file a test, 01_train_NAME.ENDING: motion, command, force_N as measured, and MODEL_force_N
    of every winner. Their names. What an earlier run wrote there goes."""
    models = list({id(one): one for one in winners(fitted).values()}.values())
    runs = [runs_of(simulator(one.damper), train, test) for one in models]
    names = []
    with output_files(folder) as staging:
        for number, of_test in enumerate(zip(*runs, strict=True), 1):
            names.append(f"{number:02d}_{stem_of(of_test[0])}.{ending}")
            write_columns(staging / names[-1], columns_of(models, of_test))
        clear_runs(folder)
    return names


def clear_runs(folder: Path) -> None:
    """Removes what write_runs has written there, and the folder where nothing else is in it."""
    if not folder.is_dir():
        return
    for file in folder.iterdir():
        if _WRITTEN.fullmatch(file.name) and file.is_file():
            file.unlink()
    if not any(folder.iterdir()):
        folder.rmdir()


def stem_of(run: Run) -> str:
    part = "test" if run.is_test else "train"
    name = run.segment.record.name.rsplit("/", 1)[-1]  # a file's begins with its folder
    return re.sub(r"[^\w.+=-]+", "_", f"{part}_{name}")


def columns_of(models: Sequence[Fitted], runs: Sequence[Run]) -> Columns:
    """Of one test: a run of each model."""
    record, rows = runs[0].segment.record, runs[0].segment.rows
    return {
        "time_s": runs[0].time_s,
        "disp_m": record.disp_m[rows],
        "velocity_m_s": record.velocity_m_s[rows],
        COMMANDS[record.command_unit]: record.command[rows],
        "force_N": runs[0].measured_N,
        **{f"{one.name}_force_N": run.model_N for one, run in zip(models, runs, strict=True)},
    }
