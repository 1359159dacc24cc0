"""Every model that was asked for, fitted, validated inside the training part, and judged."""

import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from threadpoolctl import threadpool_limits

from quiesce.damper.candidates import GREY_BOX, NETWORK, Candidate, parametric_candidates
from quiesce.damper.data.folds import MOST, MOST_QUICK, folds_of
from quiesce.damper.data.split import Segment
from quiesce.damper.fit.problem import Problem, trimmed
from quiesce.damper.fit.search import Fit
from quiesce.damper.fit_learned import keep_learned
from quiesce.damper.fit_model import fit_candidate
from quiesce.damper.fitted import PARAMETRIC, Fitted
from quiesce.damper.library import Scales
from quiesce.damper.model_file import DamperModel
from quiesce.damper.ranking import ranked
from quiesce.damper.task import Parts, Plan, Say, Told


def identify(
    train: Sequence[Segment],
    test: Sequence[Segment],
    plan: Plan,
    done: Sequence[Fitted] = (),
    told: Told = lambda _one: None,
    say: Say = lambda _text: None,
) -> list[Fitted]:
    """The models of `plan`, `done` (from an earlier run) included; told: called as each is ready.
    When plan.stop is set, models under way end with their best so far, others are left out."""
    # Cut off what follows the training rows: nothing of it may reach a fit or a choice.
    own = trimmed(train)
    # The papers' searches know no shorter way to a fold than all of it.
    is_short = plan.quick or plan.choice.method != "default"
    folds = folds_of(own, MOST_QUICK if is_short else MOST)
    parts = Parts(own, list(test), folds, Scales.of(own))
    results = {one.name: one for one in done}
    lock = threading.Lock()

    def keep(one: Fitted) -> None:
        with lock:
            results[one.name] = one
            told(one)

    chains, grey = chains_of([name for name in plan.names if name not in results])
    # Chains fill the cores; linear algebra with threads of its own only waits for them, and its
    # sums would depend on their number.
    with threadpool_limits(1):
        run_all(chains, grey, results, parts, plan, keep, say)
    return [results[name] for name in [*plan.names] if name in results]


def run_all(
    chains: Sequence[Sequence[Candidate | str]],
    grey: bool,
    results: dict[str, Fitted],
    parts: Parts,
    plan: Plan,
    keep: Told,
    say: Say,
) -> None:
    """All chains, `plan.jobs` at a time, then the grey box where there is one."""
    by_fold: dict[str, list[DamperModel]] = {}
    with ThreadPoolExecutor(plan.jobs) as pool:
        futures = [
            pool.submit(run_chain, chain, parts, plan, by_fold, keep, say) for chain in chains
        ]
        try:
            for future in futures:
                future.result()
        except BaseException:
            plan.stop.set()
            for future in futures:
                future.cancel()
            raise
    if grey and not plan.stop.is_set():
        run_grey_box(list(results.values()), parts, plan, by_fold, keep, say)


def chains_of(names: Sequence[str]) -> tuple[list[list[Candidate | str]], bool]:
    """Lists to be done one after the other; and whether a grey box comes at the end. One short one
    comes first, so that there is a model soon; then the long ones, so that the other short ones
    fill the gaps."""
    known = parametric_candidates()
    networks: list[Candidate | str] = []
    single: list[list[Candidate | str]] = []
    for name in names:
        if name.startswith(NETWORK):
            networks.append(known[name])
        elif name != GREY_BOX:
            single.append([known.get(name, name)])
    single.sort(key=lambda chain: isinstance(chain[0], str))  # learned ones are not the soonest
    chains = [*single[:1], networks, *single[1:]] if networks else single
    return chains, GREY_BOX in names


def run_chain(
    chain: Sequence[Candidate | str],
    parts: Parts,
    plan: Plan,
    by_fold: dict[str, list[DamperModel]],
    keep: Told,
    say: Say,
) -> None:
    smaller: tuple[Problem, Fit] | None = None
    for one in chain:
        if plan.stop.is_set():
            return
        if isinstance(one, str):
            keep_learned(one, parts, plan, (), keep, say)
        else:
            fitted, smaller, by_fold[one.name] = fit_candidate(one, parts, plan, smaller, say)
            keep(fitted)


def run_grey_box(
    results: Sequence[Fitted],
    parts: Parts,
    plan: Plan,
    by_fold: dict[str, list[DamperModel]],
    keep: Told,
    say: Say,
) -> None:
    """A network on top of the best parametric model. What validates it stands on a base that has
    not seen the validation rows either."""
    parametric = [one for one in results if one.kind == PARAMETRIC]
    if not parametric:
        return
    base = ranked(parametric)[0]
    if base.name not in by_fold:  # from an earlier run
        candidate = parametric_candidates()[base.name]
        by_fold[base.name] = fit_candidate(candidate, parts, plan, None, say)[2]
    say(f"{GREY_BOX}: learning what {base.name} leaves")
    keep_learned(GREY_BOX, parts, plan, [*by_fold[base.name], base.damper], keep, say)
