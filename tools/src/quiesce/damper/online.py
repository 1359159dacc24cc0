"""A damper's recording streamed past the self-tuning fuzzy model, which adapts after every sample,
and past models that were fitted to what precedes a change and are frozen then.

The adaptive model is told the measured force of each sample after it has given its own: it is an
estimator, the frozen ones are predictions. Beside it stand the force of the sample before, which
any estimator ought to beat, and the adaptive model frozen in turn. Source: STF model of the
RD-1005-3 damper, 3.3 and 4.
"""

from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from time import monotonic

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import NOISE_LEAST, NOISE_PART, Record
from quiesce.damper.data.split import Segment
from quiesce.damper.identify import identify
from quiesce.damper.learned.model import LearnedDamper, limits_of
from quiesce.damper.learned.self_tuning import LABELS, Rates, SelfTuning, scheduled_gains
from quiesce.damper.library import Scales
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate
from quiesce.damper.simulate import simulator
from quiesce.damper.task import Plan

Say = Callable[[str], None]

# The models that the source compares with.
FROZEN = ("bingham", "kwok_bouc_wen", "kwok_tanh")
ADAPTIVE = "adaptive"
STOPPED = "adaptive, stopped"
LAST_FORCE = "the last force"
# Higher than in training, where the data come again and again. Found in coarse steps on chirps of
# the RD-1005-3's published models; the source states none.
RATES = Rates(0.5, 0.1, 0.1, is_even=True, most_move=0.02)
LEAST_BEFORE_s = 1.0
_SAY_EVERY_s = 5.0


@dataclass(frozen=True)
class Stream:
    """Tests one after the other, as one: row 0 of a test follows the last of the one before."""

    records: tuple[Record, ...]
    change: int  # first row after the change

    def __len__(self) -> int:
        return sum(len(one) for one in self.records)

    @property
    def rate_Hz(self) -> float:
        return self.records[0].rate_Hz

    @property
    def time_s(self) -> np.ndarray:
        """From 0 on."""
        return np.arange(len(self)) / self.rate_Hz

    def column(self, name: str) -> np.ndarray:
        return np.concatenate([getattr(one, name) for one in self.records])

    def before(self) -> list[Segment]:
        """What precedes the change."""
        out, first = [], 0
        for one in self.records:
            rows = min(len(one), self.change - first)
            if rows > 0:
                out.append(Segment(one, 0, rows))
            first += len(one)
        return out

    def simulated(self, simulate: Simulate) -> np.ndarray:
        """Force in N, running free, from rest in every test."""
        return np.concatenate([one.averaged(simulate(one)) for one in self.records])


def stream_of(records: Sequence[Record], change_s: float | None, settle_s: float) -> Stream:
    """change_s: None where the second test begins, or the command first leaves its level.
    UsageError where there is too little before or after it."""
    rates = sorted({round(one.rate_Hz, 6) for one in records})
    if len(rates) > 1:
        raise UsageError(
            f"the tests have {' and '.join(f'{rate:g}' for rate in rates)} Hz; --work-rate-hz "
            "brings them to one rate"
        )
    stream = Stream(tuple(records), 0)
    rate_Hz, duration_s = stream.rate_Hz, len(stream) / stream.rate_Hz
    change = first_change(records) if change_s is None else int(np.ceil(change_s * rate_Hz - 1e-6))
    at = f"the change is at {change / rate_Hz:.4g} s of {duration_s:.4g} s"
    if change < LEAST_BEFORE_s * rate_Hz:
        raise UsageError(
            f"{at}; models are fitted to what precedes it, at least {LEAST_BEFORE_s:g} s: "
            "--change-s states another"
        )
    if round(settle_s * rate_Hz) < 1:
        raise UsageError(f"--settle-s {settle_s:g}: less than a row, {1.0 / rate_Hz:g} s")
    if change + settle_s * rate_Hz >= len(stream) - 1:
        raise UsageError(
            f"{at}; nothing is left {settle_s:g} s later: --change-s or --settle-s states another"
        )
    return Stream(tuple(records), change)


def first_change(records: Sequence[Record]) -> int:
    if len(records) > 1:
        return len(records[0])
    command = records[0].command
    limit = max(NOISE_PART * float(np.abs(command).max()), NOISE_LEAST)
    left = np.flatnonzero(np.abs(command - command[0]) > limit)
    if not len(left):
        raise UsageError(
            f"{records[0].name}: one test, one command: where is the change? State it with "
            "--change-s, or name a second file"
        )
    return int(left[0])


# The adaptive model


def untrained(before: Sequence[Segment]) -> SelfTuning:
    """Scales and gains of the currents from what precedes the change; memberships and outputs as
    the source starts."""
    command, force_N = (
        np.concatenate([getattr(one.record, name)[one.rows] for one in before])
        for name in ("command", "force_N")
    )
    scales = Scales.of(before)
    scale_A = max(float(command.max()), 1e-9)
    gains = scheduled_gains(command, force_N, scale_A, scales.force_N)
    return SelfTuning(scales.force_N, scales.disp_m, scales.speed_m_s, scale_A, gains)


def adapted(
    model: SelfTuning, stream: Stream, rates: Rates, keep_at: int, say: Say
) -> tuple[np.ndarray, SelfTuning]:
    """The force before each update, in N, [n]; and the model as it was at row keep_at. `model`
    ends as it is after the last row."""
    names = ("disp_m", "velocity_m_s", "command", "force_N")
    columns = [stream.column(name).tolist() for name in names]
    out = np.empty(len(stream))
    kept = model
    told_s = monotonic()
    for k, sample in enumerate(zip(*columns, strict=True)):
        if k == keep_at:
            kept = deepcopy(model)
        out[k] = model.update(*sample, rates)
        if monotonic() - told_s > _SAY_EVERY_s:
            told_s = monotonic()
            say(f"adapting: {k / stream.rate_Hz:.1f} of {len(stream) / stream.rate_Hz:.1f} s")
    return out, kept


def model_of(one: SelfTuning, before: Sequence[Segment], name: str) -> DamperModel:
    """The model as it stands, frozen, for a damper file."""
    learned = LearnedDamper(
        "neuro_fuzzy_stf", **limits_of(Scales.of(before)), parameters=one.parameters(),
        parameter_count=6 * LABELS,
    )  # fmt: skip
    return learned.as_model(name)


# Both together


@dataclass(frozen=True)
class Followed:
    """Forces in N by model, [n]: the adaptive one, those frozen at the change, and others that are
    only looked at."""

    stream: Stream
    settle_s: float
    adaptive_N: np.ndarray
    frozen_N: dict[str, np.ndarray]
    beside_N: dict[str, np.ndarray]
    start: SelfTuning
    end: SelfTuning
    notes: tuple[str, ...] = field(default=())

    def models_N(self) -> dict[str, np.ndarray]:
        """All of them."""
        return {ADAPTIVE: self.adaptive_N, **self.frozen_N, **self.beside_N}

    def parts(self) -> dict[str, slice]:
        """Rows before (its second half), during and after the change."""
        change = self.stream.change
        settled = change + round(self.settle_s * self.stream.rate_Hz)
        return {
            "before": slice(change // 2, change),
            "during": slice(change, settled),
            "after": slice(settled, None),
        }

    def error_pct(self, model_N: np.ndarray, part: str) -> float:
        """||F - F_model|| / ||F|| over a part; infinite where the model diverges."""
        rows = self.parts()[part]
        force_N = self.stream.column("force_N")[rows]
        with np.errstate(all="ignore"):
            rest = float(np.linalg.norm(force_N - model_N[rows]))
        size = max(float(np.linalg.norm(force_N)), 1e-300)
        return 100.0 * rest / size if np.isfinite(rest) else np.inf

    def errors_pct(self) -> dict[str, dict[str, float]]:
        """By model, by part."""
        return {
            name: {part: self.error_pct(force_N, part) for part in self.parts()}
            for name, force_N in self.models_N().items()
        }

    def best_frozen(self) -> str:
        """By its error after the change."""
        return min(self.frozen_N, key=lambda name: self.error_pct(self.frozen_N[name], "after"))

    def over_best_frozen(self) -> float:
        best_pct = self.error_pct(self.frozen_N[self.best_frozen()], "after")
        return self.error_pct(self.adaptive_N, "after") / best_pct

    def error_over_time_pct(self, model_N: np.ndarray, window_s: float) -> np.ndarray:
        """The same over the last window_s before every row, [n]."""
        force_N = self.stream.column("force_N")
        with np.errstate(all="ignore"):
            rest, size = (trailing((values) ** 2, round(window_s * self.stream.rate_Hz))
                          for values in (model_N - force_N, force_N))  # fmt: skip
            return 100.0 * np.sqrt(rest / np.maximum(size, 1e-300))


def trailing(values: np.ndarray, rows: int) -> np.ndarray:
    """Sums over the last `rows` values, of fewer at the start."""
    rows = max(1, rows)
    sums = np.cumsum(values)
    out = sums.copy()
    out[rows:] -= sums[:-rows]
    return np.maximum(out, 0.0)


def follow(
    stream: Stream,
    plan: Plan,
    settle_s: float = 2.0,
    rates: Rates = RATES,
    beside: Sequence[tuple[str, Simulate]] = (),
    say: Say = lambda _text: None,
) -> Followed:
    """plan: the models to fit and to freeze. beside: others, as they are; their names differ from
    those of the plan."""
    before = stream.before()
    fitted = identify(before, [], plan, say=say)
    frozen_N = {one.name: stream.simulated(simulator(one.damper)) for one in fitted}
    model = untrained(before)
    start = deepcopy(model)
    adaptive_N, at_change = adapted(model, stream, rates, stream.change, say)
    # What it had learned by then, without a measured force from then on.
    stopped_N = stream.simulated(simulator(model_of(at_change, before, STOPPED)))
    force_N = stream.column("force_N")
    others = {name: stream.simulated(simulate) for name, simulate in beside}
    notes = tuple(
        f"{one.name}: not fitted to its end" for one in fitted if not one.is_complete
    )  # fmt: skip
    return Followed(
        stream,
        settle_s,
        adaptive_N,
        {**frozen_N, STOPPED: stopped_N},
        {LAST_FORCE: np.concatenate([[0.0], force_N[:-1]]), **others},
        start,
        model,
        notes,
    )
