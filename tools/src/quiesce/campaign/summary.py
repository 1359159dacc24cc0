"""What came out of a campaign: distributions, worst cases, sensitivities, failures."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from quiesce.base.paths import shown, typed
from quiesce.campaign.file import Campaign
from quiesce.campaign.sensitivity import Sensitivity, sensitivity
from quiesce.campaign.store import Store

QUANTILES = {"least": 0.0, "5 %": 0.05, "median": 0.5, "95 %": 0.95, "most": 1.0}
WORST = 5  # cases told of each figure
ALL = "all"


@dataclass(frozen=True)
class Distribution:
    """Of a figure in one group: in how many cases there is one, and its quantiles."""

    group: str
    figure: str
    count: int
    quantiles: tuple[float, ...]  # as QUANTILES has them; empty where count is 0


@dataclass(frozen=True)
class WorstCase:
    figure: str
    value: float
    number: int
    labels: tuple[Any, ...]
    replay: str  # the command that runs it alone


@dataclass(frozen=True)
class Summary:
    """groups: values of the worst figures, by figure and by what is crossed, for plots."""

    campaign: Campaign
    cases: int
    failed: int
    reasons: list[tuple[str, int, int]]
    digest: str
    facts: dict[str, str]
    distributions: list[Distribution]
    worst: list[WorstCase]
    sensitivities: dict[tuple[str, str], Sensitivity]  # by figure and group
    groups: dict[str, dict[str, np.ndarray]] = field(repr=False)


def summary_of(campaign: Campaign, store: Store) -> Summary:
    """Of a store that has all rows."""
    design = campaign.design
    names = [group_name(campaign, i) for i in range(design.crossings)]
    distributions, worst = [], []
    found: dict[tuple[str, str], Sensitivity] = {}
    groups: dict[str, dict[str, np.ndarray]] = {}
    for figure in campaign.recipe.figures:
        values = store.column(figure)
        by_group = {name: values[i :: design.crossings] for i, name in enumerate(names)}
        distributions += [distribution(name, figure, own) for name, own in by_group.items()]
        if figure not in campaign.worst:
            continue
        groups[figure] = by_group
        worst += worst_cases(campaign, store, figure, values)
        for name, own in by_group.items():
            if (one := sensitivity(design, own)) is not None:
                found[figure, name] = one
    return Summary(
        campaign, len(design), store.failed(), store.reasons(), store.digest(), store.facts(),
        distributions, worst, found, groups,
    )  # fmt: skip


def group_name(campaign: Campaign, crossing: int) -> str:
    labels = campaign.design.crossing_labels(crossing)
    return ", ".join(str(label) for label in labels) or ALL


def distribution(group: str, figure: str, values: np.ndarray) -> Distribution:
    known = values[np.isfinite(values)]
    shares = list(QUANTILES.values())
    quantiles = tuple(float(q) for q in np.quantile(known, shares)) if known.size else ()
    return Distribution(group, figure, int(known.size), quantiles)


def worst_cases(
    campaign: Campaign, store: Store, figure: str, values: np.ndarray
) -> list[WorstCase]:
    """Largest first; of equal ones that with the lower number."""
    order = np.argsort(-np.where(np.isfinite(values), values, -math.inf), kind="stable")[:WORST]
    found = []
    for number in (int(n) for n in order if np.isfinite(values[n])):
        row = store.row(number)
        assert row is not None
        labels = row[2 : 2 + len(store.factors)]
        found.append(
            WorstCase(figure, float(values[number]), number, labels, replay(campaign, number))
        )
    return found


def replay(campaign: Campaign, number: int) -> str:
    return typed(f"quiesce campaign {shown(campaign.file)} --case {number}")


def as_data(summary: Summary) -> dict[str, Any]:
    """For programs."""
    return {
        "name": summary.campaign.name,
        "cases": summary.cases,
        "failed": summary.failed,
        "rows_sha256": summary.digest,
        "reasons": [
            {"reason": reason, "cases": count, "first": first}
            for reason, count, first in summary.reasons
        ],
        "distributions": [
            {"group": one.group, "figure": one.figure, "cases": one.count}
            | dict(zip(QUANTILES, one.quantiles, strict=False))
            for one in summary.distributions
        ],
        "worst": [
            {"figure": one.figure, "value": one.value, "case": one.number, "replay": one.replay}
            | {"factors": dict(zip(names_of(summary), one.labels, strict=True))}
            for one in summary.worst
        ],
        "sensitivity": [
            {"figure": figure, "group": group, "head": one.head, "factors": one.rows}
            | {"note": one.note}
            for (figure, group), one in summary.sensitivities.items()
        ],
    }


def names_of(summary: Summary) -> list[str]:
    return [factor.name for factor in summary.campaign.design.factors]
