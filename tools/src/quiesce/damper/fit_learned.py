"""One learned model trained: on the whole training part, then on what every fold of the validation
leaves of it."""

from collections.abc import Sequence
from dataclasses import replace
from time import monotonic
from typing import Any

from quiesce.damper import passivity
from quiesce.damper.candidates import GREY_BOX
from quiesce.damper.data.split import Segment
from quiesce.damper.fit.problem import trimmed
from quiesce.damper.fitted import BLACK_BOX, Fitted
from quiesce.damper.judge import currents_of, valid_of, without_rest
from quiesce.damper.learned import learner
from quiesce.damper.learned.model import LearnedDamper
from quiesce.damper.library import Scales
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import score
from quiesce.damper.task import Parts, Plan, Say, Told
from quiesce.damper.validated import validated

CUT_SHORT = "trained briefly: the whole training did not end in time (--time-limit)"


class Stopped(Exception):
    pass


def keep_learned(
    name: str,
    parts: Parts,
    plan: Plan,
    bases: Sequence[DamperModel],
    keep: Told,
    say: Say,
) -> None:
    """A learned model, half trained, is worth nothing; so one that is trained briefly comes first,
    whatever the time, and stands where the whole training does not end in time."""
    try:
        brief = fit_learned(name, parts, plan, bases, is_brief=True)
    except Stopped:
        say(f"{name}: left out, stopped")
        return
    if plan.quick:
        keep(brief)
        return
    say(f"{name}: trained briefly, validation {100.0 * brief.validation_error:.2f} %; goes on")
    try:
        keep(fit_learned(name, parts, plan, bases))
    except Stopped:
        keep(replace(brief, is_complete=False, notes=[*brief.notes, CUT_SHORT]))


def fit_learned(
    name: str,
    parts: Parts,
    plan: Plan,
    bases: Sequence[DamperModel] = (),
    is_brief: bool = False,
) -> Fitted:
    """bases: what a grey box stands on, fitted to what each fold leaves and to the whole training
    part. Stopped where time runs out; a brief training ends only with the plan."""
    module = learner("hysteresis_network" if name == GREY_BOX else name)
    usual = module.BRIEF if is_brief else module.Settings()
    start_s = monotonic()

    def going_on(_text: str) -> None:
        is_late = not is_brief and monotonic() - start_s > plan.seconds
        if plan.stop.is_set() or is_late:
            raise Stopped

    def train(rows: Sequence[Segment], settings: Any, k: int) -> LearnedDamper:
        settings = replace(settings, base=bases[k]) if bases else settings
        # What follows the rows of a fold validates it: not even its size may be known.
        own = trimmed(rows)
        return module.train(own, Scales.of(own), plan.seed, settings, going_on)

    trained = train(parts.train, usual, -1)
    # What a search found holds for the folds, too, where a learner says so.
    settled = replace(usual, **trained.settled)
    refits = [train(fold.fit, settled, k) for k, fold in enumerate(parts.folds)]
    checked = validated([one.simulate for one in refits], parts.folds)
    damper = trained.as_model(name, source=plan.source, valid=valid_of(parts.train))
    worst = passivity.trial(without_rest(trained.simulate), parts.scales, currents_of(parts.train))
    return Fitted(
        name,
        title_learned(name),
        BLACK_BOX,
        damper,
        trained.parameter_count,
        score(trained.simulate, parts.train),
        checked.error,
        passivity.Passivity(False, worst),
        monotonic() - start_s,
        True,
        [],
        score(trained.simulate, parts.test) if parts.test else None,
        list(trained.notes),
        checked.folds,
        checked.band,
        checked.coverage(trained.simulate, parts.test),
    )


def title_learned(name: str) -> str:
    return name.replace("_", " ")
