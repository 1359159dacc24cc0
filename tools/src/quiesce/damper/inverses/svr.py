"""Support-vector inverse in the controller's integers: i = SVR(F, x, v, and temperature where every
test has one).

The machine of support_vector.py has hundreds of vectors; a tick has time for some fifteen. Those
are chosen among its own, one after the other by what each adds to its answer at the training's
rows. Around each stands a rule with a conclusion of first order, fitted to that answer by least
squares: no support-vector machine any more, but what few rules keep of one. Few rules have to be
narrower than its hundreds of vectors: their width is the one that keeps most of its answer at rows
that they were not fitted to. (Plain Gaussians around 21 vectors keep less: 0.15 of the largest
current, root mean square, where 10 rules leave 0.08 and the machine itself 0.06.)
"""

import numpy as np

from quiesce.damper.inverses.demand import Source, checked_levels
from quiesce.damper.inverses.networks import READ_BY, NetworkInverse, inverse_of
from quiesce.damper.inverses.support_vector import (
    TEMPERATURE,
    Settings,
    beyond,
    box_around,
    has_temperature,
    told,
)
from quiesce.damper.inverses.taps import INPUTS, LEAST_SPEED, largest_speed_m_s
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.learned.support_vector import fitted
from quiesce.network import radial

NAME = "svr"
TITLE = "support-vector inverse in integers, of few vectors"
HELP = "few rules around a support-vector machine's vectors, with temperature if measured"
TRACKER = READ_BY
UNITS = {3: 16, 4: 14}  # what a tick has time for, by the number of inputs


def make(
    source: Source,
    seed: int = 0,
    progress: Report = silent,
    settings: Settings | None = None,
    with_temperature: bool | None = None,
) -> NetworkInverse:
    """with_temperature None: where every test has one. UsageError where the current is the same
    throughout."""
    settings = settings or Settings()
    checked_levels(source)
    rng = np.random.default_rng(seed)
    if with_temperature is None:
        with_temperature = all(has_temperature(one) for one in source.segments)
    keys = (*INPUTS, TEMPERATURE) if with_temperature else INPUTS
    least_m_s = LEAST_SPEED * largest_speed_m_s(source.segments)
    seen, part = beyond(*told(source, keys, least_m_s), settings, rng)
    rows = rng.permutation(len(seen))
    box = box_around(keys, seen)
    x, some = box.scaled(seen[rows]), rows[: settings.rows]
    machine = fitted(
        box.scaled(seen[some]), part[some], settings.penalty, settings.gamma, settings.epsilon
    )
    asked = x[: 2 * settings.rows]
    answers = np.clip(machine.predict(asked), 0.0, 1.0)
    vectors = radial.with_centres(
        asked, answers, machine.support_vectors_, float(np.sqrt(settings.gamma)), UNITS[len(keys)]
    )
    few = radial.best_rules(vectors, asked, answers)
    most_A = source.max_current_A
    layers = few.layers(1e3 * most_A)
    error = np.sqrt(np.mean((np.clip(layers.sums_mA(x) / 1e3 / most_A, 0, 1) - part[rows]) ** 2))
    progress(
        f"{NAME}: {len(few.centres)} of {len(machine.support_vectors_)} vectors, "
        f"{error * most_A:.3g} A root mean square on {len(x)} rows"
    )
    return inverse_of(box, layers, most_A, least_m_s)
