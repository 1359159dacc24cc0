"""`identify --method ls`: the normalised Bouc-Wen model from three sines a current, without a
search (fit/least_squares_bouc_wen.py)."""

from collections.abc import Sequence
from time import monotonic

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, levels_of
from quiesce.damper.fit.least_squares_bouc_wen import BoucWenFit, Sines, fit, fit_currents
from quiesce.damper.fitted import PARAMETRIC, Fitted
from quiesce.damper.judge import MARGIN, valid_of
from quiesce.damper.library import RIG, Scales
from quiesce.damper.model_file import from_row
from quiesce.damper.passivity import Passivity, is_proved
from quiesce.damper.score import score
from quiesce.damper.simulate import simulator
from quiesce.damper.task import Plan

MODEL = "normalised_bouc_wen"
NAME = "normalised_bouc_wen_ls"
MOST_POWER = 2


def closed_form(train: Sequence[Segment], test: Sequence[Segment], plan: Plan) -> Fitted:
    """The training records by current, three each in this order: a sine, the same about another
    displacement, the same at another frequency. UsageError where they are not that."""
    start_s = monotonic()
    sines = triples(train)
    fits = [fit(sines[0])] if len(sines) == 1 else fit_currents(sines, 0)[0]
    row, orders = row_of(fits)
    one = library.model(MODEL)
    scales = Scales.of(train)
    damper = from_row(
        one,
        orders,
        row,
        NAME,
        MARGIN * scales.disp_m,
        MARGIN * scales.speed_m_s,
        source=plan.source,
        valid=valid_of(train),
    )
    simulate = simulator(damper)
    trained = score(simulate, train)
    currents = [found.current for found in fits]
    return Fitted(
        NAME,
        one.title + ", least squares",
        PARAMETRIC,
        damper,
        int(sum(orders)),
        trained,
        trained.mean_error,  # nothing is left to validate on
        Passivity(is_proved(one, orders, row, currents), 0.0),
        monotonic() - start_s,
        True,
        [],
        score(simulate, test) if test else None,
        ["three sines a current by least squares; the validation error is that of the same rows"],
    )


def triples(segments: Sequence[Segment]) -> list[Sines]:
    records: list[Record] = [segment.record for segment in segments]
    out = []
    for level in levels_of(segments):
        three = [one for one in records if one.level is not None and abs(one.level - level) < 0.02]
        if len(three) != 3:
            raise UsageError(
                f"--method ls needs three tests at each current (a sine, the same about another "
                f"displacement, the same at another frequency); at {level:g} there are "
                f"{len(three)}. Keep the displacement's mean with --keep-offset"
            )
        out.append(Sines(*three))
    if not out:
        raise UsageError("--method ls needs tests at constant current")
    return out


def row_of(fits: Sequence[BoucWenFit]) -> tuple[np.ndarray, list[int]]:
    """The library's row: through the parameters of up to three currents, else a quadratic."""
    one = library.model(MODEL)
    power = min(len(fits) - 1, MOST_POWER)
    currents = np.array([found.current for found in fits])
    values = np.array(
        [[found.normalised()[each.name] for each in one.parameters] for found in fits]
    )
    laws = np.polynomial.polynomial.polyfit(currents, values, power)
    row = np.concatenate([*laws.T, np.zeros(len(RIG))])
    return row, [power + 1] * len(one.parameters)
