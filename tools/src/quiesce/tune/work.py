"""The pieces of work of `quiesce tune`: what each computes, and many of them by processes."""

import hashlib
import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.pools import Processes
from quiesce.base.progress import Progress
from quiesce.base.runner import run_each
from quiesce.optimum.bound import bound
from quiesce.optimum.constant import best_constant
from quiesce.optimum.goal import ACCEL, AMP, NO_WORSE, Goal, Reference, reference
from quiesce.optimum.periodic import Orbit, drive, solve
from quiesce.plant.library import Plant
from quiesce.plant.variant import Variant, write_variant
from quiesce.tune.plan import Quality, TunePlan
from quiesce.tune.pulse import Pulse
from quiesce.tune.setting import Setting
from quiesce.tune.store import TuneStore, pulse_method
from quiesce.tune.tables import Candidate, TableCase, candidates

CONSTANT_STEPS = 20
FRONT_QUALITY = Quality(30, 1, 0)
# Every process does one piece; more threads inside it only get into each other's way.
ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class BoundWork:
    """Bounds and constant currents at one frequency."""

    plant: Path
    freq_Hz: float
    quality: Quality

    @property
    def key(self) -> str:
        return f"bound {self.freq_Hz:g} Hz"

    def compute(self) -> dict[str, Any]:
        ref = reference(drive(Plant(self.plant), self.freq_Hz))
        goals = {"amp": AMP, "accel": ACCEL}
        bounds = {name: _bound(ref, goal, self.quality) for name, goal in goals.items()}
        is_kept = bounds["amp"]["accel_red_pct"] >= 0.0
        bounds["no_worse"] = bounds["amp"] if is_kept else _bound(ref, NO_WORSE, self.quality)
        return {
            "uncontrolled": {
                "amp_um": 1e6 * ref.orbit.amp_m,
                "accel_rms_mm_s2": 1e3 * ref.orbit.accel_rms_m_s2,
            },
            "bounds": bounds,
            "constants": _constants(ref),
        }


@dataclass(frozen=True)
class PulseWork:
    """A setting's pulses at one frequency."""

    plant: Path
    freq_Hz: float
    name: str
    setting: Setting
    bound_pct: float  # that its fractions are of

    @property
    def key(self) -> str:
        """Other weights, another key: results of both are kept."""
        wanted = hashlib.sha256(f"{self.setting} {pulse_method()}".encode()).hexdigest()[:8]
        return f"{self.name} {wanted} {self.freq_Hz:g} Hz"

    def compute(self) -> list[dict[str, Any]]:
        case = TableCase(Plant(self.plant), self.setting, self.freq_Hz, self.bound_pct)
        return [asdict(candidate) for candidate in candidates(case)]


def candidate_of(data: dict[str, Any]) -> Candidate:
    return Candidate(**{**data, "pulse": Pulse(**data["pulse"])})


@dataclass(frozen=True)
class FrontWork:
    """Least displacement for several limits of the acceleration, any current allowed."""

    plant: Path
    freq_Hz: float
    count: int  # of limits

    @property
    def key(self) -> str:
        return f"front {self.freq_Hz:g} Hz"

    def compute(self) -> list[dict[str, float]]:
        ref = reference(drive(Plant(self.plant), self.freq_Hz))
        ends = [_bound(ref, goal, FRONT_QUALITY) for goal in (ACCEL, AMP)]
        reds_pct = [end["accel_red_pct"] for end in ends]
        between = np.linspace(*reds_pct, self.count + 2)[1:-1]
        goals = [Goal(accel_limit=1.0 - float(red_pct) / 100.0) for red_pct in between]
        return [ends[0], *(_bound(ref, goal, FRONT_QUALITY) for goal in goals), ends[1]]


@dataclass(frozen=True)
class VariantWork:
    """Bound and best constant current of a plant that differs from the one tuned for."""

    plant: Path
    variant: Variant
    freq_Hz: float
    quality: Quality

    @property
    def key(self) -> str:
        return f"{self.variant.name} {self.freq_Hz:g} Hz"

    def compute(self) -> dict[str, Any]:
        with variant_plant(self.plant, self.variant) as plant:
            ref = reference(drive(plant, self.freq_Hz))
            constant = best_constant(ref.drive, AMP)
            return {
                "amp_um": 1e6 * ref.orbit.amp_m,
                "accel_rms_mm_s2": 1e3 * ref.orbit.accel_rms_m_s2,
                "bound": _bound(ref, AMP, self.quality),
                "constant": {"current_A": constant.current_A, **figures(ref, constant.orbit)},
            }


Work = BoundWork | FrontWork | VariantWork | PulseWork


@contextmanager
def variant_plant(plant: Path, variant: Variant) -> Iterator[Plant]:
    """Its file lasts as long as the block."""
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        file = Path(folder) / "plant.toml"
        write_variant(plant, variant, file)
        yield Plant(file)


def figures(ref: Reference, orbit: Orbit) -> dict[str, float]:
    return {
        "amp_red_pct": ref.amp_reduction_pct(orbit),
        "accel_red_pct": ref.accel_reduction_pct(orbit),
        "mean_current_A": orbit.mean_current_A,
    }


def _bound(ref: Reference, goal: Goal, quality: Quality) -> dict[str, float]:
    found = bound(ref.drive, goal, intervals=quality.intervals, starts=quality.starts)
    return figures(ref, found.orbit)


def _constants(ref: Reference) -> list[dict[str, float]]:
    levels_A = np.linspace(0.0, ref.drive.plant.max_current_A, CONSTANT_STEPS + 1)
    orbits = [solve(ref.drive, level_A) for level_A in levels_A]
    return [
        {"current_A": float(level_A), **figures(ref, orbit)}
        for level_A, orbit in zip(levels_A, orbits, strict=True)
    ]


def fronts(plan: TunePlan) -> list[FrontWork]:
    return [FrontWork(plan.plant, freq_Hz, plan.quality.front_points) for freq_Hz in plan.shown_Hz]


def bound_works(plan: TunePlan) -> list[BoundWork]:
    return [BoundWork(plan.plant, freq_Hz, plan.quality) for freq_Hz in plan.freqs_Hz]


def pulse_works(plan: TunePlan, store: TuneStore) -> list[PulseWork]:
    """All settings of one frequency, then of the next. The bounds must be in the store."""
    out = []
    for work in bound_works(plan):
        bounds = store[work.key]["bounds"]
        for name, setting in plan.settings.items():
            bound_pct = bounds["no_worse" if setting.of_no_worse else "amp"]["amp_red_pct"]
            out.append(PulseWork(plan.plant, work.freq_Hz, name, setting, bound_pct))
    return out


def variant_works(plan: TunePlan) -> list[VariantWork]:
    return [
        VariantWork(plan.plant, variant, freq_Hz, plan.quality)
        for freq_Hz in plan.shown_Hz
        for variant in plan.variants
    ]


def compute_plan(store: TuneStore, plan: TunePlan, jobs: int) -> None:
    """All that a plan asks for; the slowest pieces, at low frequencies, first."""
    compute_all(store, [*bound_works(plan), *fronts(plan), *variant_works(plan)], jobs)
    compute_all(store, pulse_works(plan, store), jobs)


def compute(work: Work) -> Any:
    return work.compute()


def compute_all(store: TuneStore, pieces: Sequence[Work], jobs: int) -> None:
    """Computes what the store does not hold; every piece is stored as it is finished."""
    todo = [work for work in pieces if work.key not in store]
    if not todo:
        return
    progress = Progress(len(todo))
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")

    def keep(number: int, result: Any) -> None:
        store.put(todo[number].key, result)
        progress.done(todo[number].key)

    with closing(Processes(min(jobs, len(todo)))) as pool:
        run_each(pool, [(compute, (work,)) for work in todo], keep)
