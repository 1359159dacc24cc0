"""All laws on all records with all seeds, on the bench; beside them no current, all current, the
best constant current, which only hindsight knows, and where it is asked for the clairvoyant's."""

import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from quiesce.compare.clairvoyant import CLAIRVOYANT, Found, Stage, clairvoyant
from quiesce.compare.figures import (
    ALL_FIGURES,
    FIGURES,
    Contact,
    Figures,
    columns,
    figures_of,
    index,
)
from quiesce.compare.goal import Goal, read_goal
from quiesce.compare.laws import ComparedLaw, constant
from quiesce.compare.names import ACCEL, TIME
from quiesce.compare.records import Record
from quiesce.engine.bench import Bench
from quiesce.engine.board import Board, load_board
from quiesce.engine.pool import WORKERS, run_work
from quiesce.engine.scenarios import read_toml
from quiesce.engine.trace import Trace, read_trace
from quiesce.optimum.waveform import Effort

OFF, ALL, BEST = "no current", "all current", "best constant"
GRID = 8  # constant currents between none and all that hindsight looks at
AFTER_s = 2.0  # that a record is followed by
LAWS_AS_STARTS = 2  # of a search for the clairvoyant's waveform, the best ones on the record
BY_INDEX = read_goal("index")
EFFORT = Effort()


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
    """rig: its board's name. index: against all current, same record and seed. share: of what the
    clairvoyant gains over the best constant current, where it is known."""

    rig: str
    law: str
    record: str
    seed: int
    figures: Figures
    index: float
    note: str = ""
    share: float | None = None


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
        self,
        laws: Sequence[ComparedLaw],
        records: Sequence[Record],
        seeds: Sequence[int],
        goal: Goal = BY_INDEX,
    ) -> list[Cell]:
        """Of the laws and the three references, record by record and seed by seed. goal: of the
        best constant current."""
        goal.require(bool(self._contacts))
        wanted = [*self.constants(), *laws]
        cases = [Case(law, r, seed) for r in records for seed in seeds for law in wanted]
        found = self.figures(cases)
        count = len(wanted)
        return [
            cell
            for first in range(0, len(cases), count)
            for cell in self._group(
                cases[first : first + count], found[first : first + count], goal
            )
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

    def with_clairvoyant(
        self,
        cells: Sequence[Cell],
        laws: Sequence[ComparedLaw],
        records: Sequence[Record],
        goal: Goal,
        effort: Effort = EFFORT,
    ) -> tuple[list[Cell], dict[str, Found]]:
        """The cells, of these laws and records and this goal, with the best waveform that was found
        beside each record's and seed's, and what was found for each record."""
        work = [
            (f"{CLAIRVOYANT}, {one.name}", partial(self._found, one, cells, laws, goal, effort))
            for one in records
        ]
        of_records = run_work(self._bench, work)
        found = {one.name: it for one, it in zip(records, of_records, strict=True)}
        groups = dict.fromkeys((cell.record, cell.seed) for cell in cells)
        out: list[Cell] = []
        for record, seed in groups:
            own = [cell for cell in cells if (cell.record, cell.seed) == (record, seed)]
            out += beside(own, found[record].figures, goal)
        return out, found

    def stage(self, record: Record) -> Stage:
        """What a run of a record simulates, without the controller."""
        shaking = self._shaking
        return Stage(
            self.rig.plant, self.rig.board, tuple(self._contacts), record, shaking.time_scale,
            shaking.gain_of(record), self._lasts_s(record),
        )  # fmt: skip

    def _found(
        self, record: Record, cells: Sequence[Cell], laws: Sequence[ComparedLaw], goal: Goal,
        effort: Effort,
    ) -> Found:  # fmt: skip
        """From the waveforms of the laws that are best on the record's first seed."""
        seed = next(cell.seed for cell in cells if cell.record == record.name)
        own = {c.law: c.figures for c in cells if (c.record, c.seed) == (record.name, seed)}
        best = sorted(laws, key=lambda law: goal.value(own[law.label], own[ALL]))
        stage = self.stage(record)
        starts = [
            stage.commands_of(self.trace(Case(law, record, seed))) for law in best[:LAWS_AS_STARTS]
        ]
        return clairvoyant(stage, goal, own[ALL], starts, effort)

    def references(self) -> list[ComparedLaw]:
        return [constant(0, OFF), constant(self.rig.all_mA, ALL)]

    def constants(self) -> list[ComparedLaw]:
        """GRID + 1 constant currents, from none to all."""
        none, all_current = self.references()
        all_mA = self.rig.all_mA
        steps = [constant(round(all_mA * i / GRID), f"{i}") for i in range(1, GRID)]
        return [none, *steps, all_current]

    def trace(self, case: Case, further: Sequence[str] = ()) -> Trace:
        """Of one case, for plots; with these columns of the bench beside the usual ones."""
        with tempfile.TemporaryDirectory(prefix="quiesce-compare-") as name:
            return self._run(case, self._scenario(Path(name), case.record), further)

    def _figures(self, case: Case, file: Path) -> Figures:
        trace = self._run(case, file)
        return figures_of(trace, self.rig.board.bodies, self.rig.board.dampers, self._contacts)

    def _run(self, case: Case, file: Path, further: Sequence[str] = ()) -> Trace:
        board = self.rig.board
        names = [*columns(board.bodies, board.dampers), *further]
        with tempfile.NamedTemporaryFile(prefix="quiesce-compare-", suffix=".trace") as trace:
            self._bench.json(
                "run", "--scenario", str(file), "--law", case.law.law, "--seed", str(case.seed),
                "--trace", trace.name, "--columns", ",".join(names),
                *case.law.options,
            )  # fmt: skip
            return read_trace(Path(trace.name))

    def _scenario(self, folder: Path, record: Record) -> Path:
        """The record goes on for a moment without ground motion."""
        motion = folder / f"{record.name}.csv"
        motion.write_text(record.csv(), encoding="ascii")
        file = folder / f"{record.name}.toml"
        lasts_s = self._lasts_s(record)
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

    def _lasts_s(self, record: Record) -> float:
        return record.duration_s / self._shaking.time_scale + AFTER_s

    def _group(self, cases: Sequence[Case], found: Sequence[Figures], goal: Goal) -> list[Cell]:
        """Of one record and seed: the grid of constants becomes its best one."""
        all_current = found[GRID]
        rig = self.rig.board.name
        cells = [
            Cell(rig, c.law.label, c.record.name, c.seed, figures, index(figures, all_current))
            for c, figures in zip(cases, found, strict=True)
        ]
        best = min(range(GRID + 1), key=lambda i: goal.value(found[i], all_current))
        amperes = f"{1e-3 * self.rig.all_mA * best / GRID:.4g} A"
        one = cells[best]
        hindsight = Cell(rig, BEST, one.record, one.seed, one.figures, one.index, amperes)
        return [cells[0], cells[GRID], hindsight, *cells[GRID + 1 :]]


def beside(cells: Sequence[Cell], found: Figures, goal: Goal) -> list[Cell]:
    """The cells of one record and seed with the clairvoyant's after the best constant's, and the
    share of its gain that each has."""
    figures = {cell.law: cell.figures for cell in cells}
    all_current = figures[ALL]
    constant_value = goal.value(figures[BEST], all_current)
    gain = constant_value - goal.value(found, all_current)
    first = cells[0]
    note = f"the best waveform found for {goal.name}, not a proof"
    index_ = index(found, all_current)
    own = Cell(first.rig, CLAIRVOYANT, first.record, first.seed, found, index_, note)
    at = 1 + next(i for i, cell in enumerate(cells) if cell.law == BEST)
    if gain <= 0.0:  # no waveform was found that is better than a constant current
        return [*cells[:at], own, *cells[at:]]
    return [
        replace(cell, share=(constant_value - goal.value(cell.figures, all_current)) / gain)
        for cell in [*cells[:at], own, *cells[at:]]
    ]
