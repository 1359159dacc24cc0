"""Whole currents, motions and amplitudes of the measured dampers held out, one at a time."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from quiesce.damper.data.folds import QUARTERS, Fold, folds_of, spread
from quiesce.damper.data.record import Record
from quiesce.damper.data.records import records_of_set
from quiesce.damper.data.split import whole

from quiesce_benchmarks.damper.real import rules
from quiesce_benchmarks.unseen.measured import entries

# Names of entries(), by damper and way of recording. A set of one test has nothing whole to leave
# out: the switched damper and Sano's are in no case.
DAMPERS = {
    "utfsm_sines": ("utfsm_sines",),
    "utfsm_raw": ("utfsm_sine_3Hz", "utfsm_sweep_0A", "utfsm_sweep_1A"),
    "utfpr_table": ("utfpr_table",),
}
# What --quick looks at: some minutes.
QUICK = ("utfpr_table",)
_ALL = 1000


@dataclass(frozen=True)
class Case:
    """`held` has what may be fitted (`fit`) and what is judged (`validation`)."""

    damper: str
    held: Fold

    @property
    def name(self) -> str:
        return f"{self.damper} without {self.held.left_out}"


def records_of(folder: Path, names: tuple[str, ...]) -> list[Record]:
    by_name = {one["name"]: one for one in entries()}
    low_pass_Hz = rules()["displacement_low_pass_Hz"]
    return [
        record
        for name in names
        for record in records_of_set(by_name[name], folder, low_pass_Hz).records
    ]


def cases_of(damper: str, records: list[Record], most: int = _ALL) -> Iterator[Case]:
    """`most` of a kind; none where nothing whole can be left out."""
    held = folds_of([whole(one) for one in records], _ALL)
    for kind in dict.fromkeys(one.kind for one in held if one.kind != QUARTERS):
        for one in spread([fold for fold in held if fold.kind == kind], most):
            yield Case(damper, one)


def all_cases(folder: Path, is_quick: bool) -> list[Case]:
    """--quick: one of a kind, of the smallest damper's files."""
    names, most = (QUICK, 1) if is_quick else (tuple(DAMPERS), _ALL)
    return [
        case
        for damper in names
        for case in cases_of(damper, records_of(folder, DAMPERS[damper]), most)
    ]
