"""All laws on all records with all seeds, on the bench; beside them no current, all current, and
the best constant current, which only hindsight knows."""

import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from quiesce.compare.figures import (
    ALL_FIGURES,
    FIGURES,
    Contact,
    Figures,
    columns,
    figures_of,
    index,
)  # fmt: skip
from quiesce.compare.laws import ComparedLaw, constant
from quiesce.compare.names import ACCEL, TIME
from quiesce.compare.records import Record
from quiesce.engine.bench import Bench
from quiesce.engine.board import Board, load_board
from quiesce.engine.pool import WORKERS, run_work
from quiesce.engine.scenarios import read_toml
from quiesce.engine.trace import Trace, read_trace

OFF, ALL, BEST = "no current", "all current", "best constant"
GRID = 8  # constant currents between none and all that hindsight looks at
AFTER_s = 2.0  # that a record is followed by


@dataclass(frozen=True)
class Rig:
    plant: Path
    board: Board

    @property
    def all_mA(self) -> int:
        return self.board.ceiling_mA


def contacts_of(plant: Path) -> list[Contact]:
    """Its mounts of kind contact between a body and the base; the bench checks the file."""
    return [
        Contact(one["a"], one["stiffness_N_m"], one.get("damping_N_s_m", 0.0), one["preload_N"])
        for one in read_toml(plant).get("mount", [])
        if one.get("kind") == "contact" and one.get("b") == "ground"
    ]


@dataclass(frozen=True)
class Shaking:
    """How records shake: gain and time_scale of each; with scale_to every peak is that."""

    time_scale: float = 1.0
    gain: float = 1.0
    scale_to_m_s2: float | None = None

    def gain_of(self, record: Record) -> float:
        return self.gain if self.scale_to_m_s2 is None else self.scale_to_m_s2 / record.peak_m_s2


@dataclass(frozen=True)
class Cell:
    """index: against all current, same record and seed."""

    law: str
    record: str
    seed: int
    figures: Figures
    index: float
    note: str = ""


@dataclass(frozen=True)
class Case:
    law: ComparedLaw
    record: Record
    seed: int


class Comparison:
    """UsageError, in the bench's words, where plant, board or a law's options are not right."""

    def __init__(self, bench: Bench, plant: Path, board: Path, shaking: Shaking) -> None:
        self._bench = bench
        self.rig = Rig(plant.resolve(), load_board(bench, board))
        self._contacts = contacts_of(plant)
        self._shaking = shaking

    @property
    def figure_names(self) -> list[str]:
        """What a run of this structure has figures of."""
        return [name for name, _, _ in (ALL_FIGURES if self._contacts else FIGURES)]

    def cells(
        self, laws: Sequence[ComparedLaw], records: Sequence[Record], seeds: Sequence[int]
    ) -> list[Cell]:
        """Of the laws and the three references, record by record and seed by seed."""
        wanted = [*self.constants(), *laws]
        cases = [Case(law, r, seed) for r in records for seed in seeds for law in wanted]
        found = self.figures(cases)
        count = len(wanted)
        return [
            cell
            for first in range(0, len(cases), count)
            for cell in self._group(cases[first : first + count], found[first : first + count])
        ]

    def figures(self, cases: Sequence[Case], workers: int = WORKERS) -> list[Figures]:
        """Of these cases alone, in order; progress on stderr."""
        records = {case.record.name: case.record for case in cases}
        with self.ready(list(records.values())) as run:
            pieces = [
                (f"{one.law.label}, {one.record.name}, seed {one.seed}", partial(run, one))
                for one in cases
            ]
            return run_work(self._bench, pieces, workers)

    @contextmanager
    def ready(self, records: Sequence[Record]) -> Iterator[Callable[[Case], Figures]]:
        """What runs a case on one of these records, also from several threads at once."""
        with tempfile.TemporaryDirectory(prefix="quiesce-compare-") as name:
            folder = Path(name)
            files = {record.name: self._scenario(folder, record) for record in records}
            yield lambda case: self._figures(case, files[case.record.name])

    def references(self) -> list[ComparedLaw]:
        return [constant(0, OFF), constant(self.rig.all_mA, ALL)]

    def constants(self) -> list[ComparedLaw]:
        """GRID + 1 constant currents, from none to all."""
        none, all_current = self.references()
        all_mA = self.rig.all_mA
        steps = [constant(round(all_mA * i / GRID), f"{i}") for i in range(1, GRID)]
        return [none, *steps, all_current]

    def trace(self, case: Case) -> Trace:
        """Of one case, for plots."""
        with tempfile.TemporaryDirectory(prefix="quiesce-compare-") as name:
            return self._run(case, self._scenario(Path(name), case.record))

    def _figures(self, case: Case, file: Path) -> Figures:
        trace = self._run(case, file)
        return figures_of(trace, self.rig.board.bodies, self.rig.board.dampers, self._contacts)

    def _run(self, case: Case, file: Path) -> Trace:
        board = self.rig.board
        with tempfile.NamedTemporaryFile(prefix="quiesce-compare-", suffix=".trace") as trace:
            self._bench.json(
                "run", "--scenario", str(file), "--law", case.law.law, "--seed", str(case.seed),
                "--trace", trace.name, "--columns", ",".join(columns(board.bodies, board.dampers)),
                *case.law.options,
            )  # fmt: skip
            return read_trace(Path(trace.name))

    def _scenario(self, folder: Path, record: Record) -> Path:
        """The record goes on for a moment without ground motion."""
        motion = folder / f"{record.name}.csv"
        motion.write_text(record.csv(), encoding="ascii")
        file = folder / f"{record.name}.toml"
        lasts_s = record.duration_s / self._shaking.time_scale + AFTER_s
        file.write_text(
            'schema = "quiesce-scenario"\nversion = 1\n'
            f'name = "compared"\nplant = "{self.rig.plant}"\n'
            f'board = "{self.rig.board.file.resolve()}"\nduration_s = {lasts_s:.6f}\n'
            f'[[segment]]\nkind = "record"\nfile = "{motion}"\ntime_column = "{TIME}"\n'
            f'accel_column = "{ACCEL}"\ntime_scale = {self._shaking.time_scale!r}\n'
            f"gain = {self._shaking.gain_of(record)!r}\n"
            f"[[window]]\nstart_s = 0.0\nend_s = {lasts_s:.6f}\n",
            encoding="utf-8",
        )
        return file

    def _group(self, cases: Sequence[Case], found: Sequence[Figures]) -> list[Cell]:
        """Of one record and seed: the grid of constants becomes its best one."""
        all_current = found[GRID]
        cells = [
            Cell(c.law.label, c.record.name, c.seed, figures, index(figures, all_current))
            for c, figures in zip(cases, found, strict=True)
        ]
        best = min(range(GRID + 1), key=lambda i: cells[i].index)
        amperes = f"{1e-3 * self.rig.all_mA * best / GRID:.4g} A"
        one = cells[best]
        hindsight = Cell(BEST, one.record, one.seed, one.figures, one.index, amperes)
        return [cells[0], cells[GRID], hindsight, *cells[GRID + 1 :]]
