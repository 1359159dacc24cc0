"""The page: what was promised, what is, and what any current could do; and before and after."""

import json
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.before_after.data import as_data
from quiesce.before_after.files.open_file import How, open_file
from quiesce.before_after.page import page as before_after_page
from quiesce.before_after.run import Options, compared
from quiesce.commission.page import page
from quiesce.commission.steps.verify import AFTER, BEFORE
from quiesce.commission.work import Work

NAME = "report"
TITLE = "report"
PAGE, DATA, PAIR = "report.html", "report.json", "before_after.html"


def run(work: Work) -> dict[str, Any]:
    pair = before_and_after(work)
    steps = dict(work.folder.results)
    with output_files(work.path) as staging:
        (staging / PAGE).write_text(page(work, pair is not None), encoding="utf-8")
        data = {"wants": work.wants.data(), "settings": work.folder.settings, "steps": steps}
        (staging / DATA).write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
        if pair is not None:
            (staging / PAIR).write_text(pair[0], encoding="utf-8")
    return {"page": PAGE, "share": work.result("verify")["share"],
            "before_after": pair[1] if pair else None}  # fmt: skip


def before_and_after(work: Work) -> tuple[str, dict[str, Any]] | None:
    """The page that 'quiesce report' makes of both recordings, and its figures. None where they
    are no use to it; the table has what was measured."""
    freq_Hz = work.result("verify")["recorded_Hz"]
    how = How(None, None, 0)
    try:
        found = compared(
            open_file(work.path / BEFORE, how),
            open_file(work.path / AFTER, how),
            Options(title=f"Vibration at {freq_Hz:.3g} Hz, without control and with it"),
        )
    except UsageError as error:
        work.tell(f"no page of before and after: {error}")
        return None
    return before_after_page(found), as_data(found)


def line(result: dict[str, Any]) -> str:
    return f"{result['page']}: {100 * result['share']:.0f} % of the bound"
