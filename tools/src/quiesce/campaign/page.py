"""The page of a campaign: what came out, the worst cases, what matters, where it comes from."""

from quiesce.campaign import plots, tables
from quiesce.campaign.summary import Summary
from quiesce.report.page import render


def page(summary: Summary) -> str:
    worst_of = {}
    for one in summary.worst:
        worst_of.setdefault(one.figure, one)
    cards = [
        (f"{summary.cases:,}", "cases"),
        (str(summary.failed), "of them failed", summary.failed > 0),
        *((tables.told(one.value), f"largest {one.figure}, case {one.number}")
          for one in worst_of.values()),
    ]  # fmt: skip
    return render(
        "campaign/page.html.j2",
        summary=summary,
        cards=cards,
        distributions=tables.distributions(summary),
        histograms={name: plots.histogram(name, own) for name, own in summary.groups.items()},
        drawn=plots.DRAWN,
        worst=tables.worst(summary),
        sensitivities=[
            (figure, group, tables.sensitivity(one), one.note)
            for (figure, group), one in summary.sensitivities.items()
        ],
        failures=tables.failures(summary),
        facts=tables.facts(summary),
    )
