"""Law `network` fitted to samples: what another controller, a model predictive one or an optimum's
waveform made of the same signals."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.law.forms.network import NetworkSection, NetworkTable, Span
from quiesce.law.rig import LawRig
from quiesce.law.signal import BY_NAME, Signal, signal
from quiesce.network import dense, radial
from quiesce.network.integers import of_dense
from quiesce.network.layers import Layers

KINDS = {
    "tanh": "one layer of tanh units",
    "radial": "Gaussians around chosen samples",
    "rules": "the same normalised, with conclusions of first order (TSK)",
}
_EPOCHS, _DECAY, _MOST_ROWS = 120, 1e-4, 20_000
_HELD = 5  # every so manyth row is not fitted


@dataclass(frozen=True)
class Fit:
    """error_A, a damper: root mean square on rows that were not fitted; spread_A: what the output's
    mean alone would leave there."""

    table: NetworkTable
    error_A: tuple[float, ...]
    spread_A: tuple[float, ...]


def signal_on(rig: LawRig, told: str) -> Signal:
    """ "QUANTITY of PLACE". UsageError where the board has none such."""
    quantity, _, place = told.partition(" of ")
    at = 0
    if quantity in BY_NAME and told in rig.signals:
        of = BY_NAME[quantity].of
        places = rig.bodies if of == "body" else [one.name for one in rig.dampers]
        at = 0 if of == "board" else list(places).index(place)
        return signal(quantity, at)
    known = ", ".join(sorted(rig.signals))
    raise UsageError(f"board {rig.name} has no '{told}'; it has: {known}")


def fit(
    rig: LawRig,
    signals: Sequence[str],
    values: np.ndarray,
    currents_A: np.ndarray,
    kind: str,
    units: int,
    seed: int,
) -> Fit:
    """values [rows signals] in SI units, currents_A [rows dampers], the first ones of the board.
    UsageError, in one line, where they do not allow it."""
    if currents_A.shape[1] > len(rig.dampers):
        raise UsageError(
            f"{currents_A.shape[1]} outputs; board {rig.name} has {len(rig.dampers)} dampers"
        )
    seen = [signal_on(rig, told) for told in signals]
    spans = tuple(_span(one, column) for one, column in zip(seen, values.T, strict=True))
    x = np.stack([one.scaled(column) for one, column in zip(spans, values.T, strict=True)], axis=1)
    sections, errors, spreads = [], [], []
    for damper, target_A in zip(rig.dampers, currents_A.T, strict=False):
        most_A = 1e-3 * damper.ceiling_mA
        target = np.clip(target_A / most_A, 0.0, 1.0)
        if not np.ptp(target) > 0.0:
            raise UsageError(f"the current of {damper.name} is the same throughout")
        section, error, spread = _section(spans, x, target, damper.ceiling_mA, kind, units, seed)
        sections.append(section)
        errors.append(error * most_A)
        spreads.append(spread * most_A)
    table = NetworkTable(tuple(sections))
    try:
        table.words()
    except ValueError as error:
        raise UsageError(f"{kind}: {error}") from None
    return Fit(table, tuple(errors), tuple(spreads))


def _span(wanted: Signal, column: np.ndarray) -> Span:
    low, high = float(column.min()), float(column.max())
    if not high > low:
        raise UsageError(f"{wanted.name} is the same throughout: it tells nothing")
    return Span.of(wanted, low, high)


def _section(
    spans: tuple[Span, ...],
    x: np.ndarray,
    target: np.ndarray,
    ceiling_mA: int,
    kind: str,
    units: int,
    seed: int,
) -> tuple[NetworkSection, float, float]:
    rng = np.random.default_rng(seed)
    rows = rng.permutation(len(x))[:_MOST_ROWS]
    held, told = rows[::_HELD], np.setdiff1d(rows, rows[::_HELD])
    layers = _layers(x[told], target[told], ceiling_mA, kind, units, rng)
    found = np.clip(layers.sums_mA(x[held]) / ceiling_mA, 0.0, 1.0)
    error = float(np.sqrt(np.mean((found - target[held]) ** 2)))
    return NetworkSection(spans, 0, ceiling_mA, layers), error, float(np.std(target[held]))


def _layers(
    x: np.ndarray,
    target: np.ndarray,
    unit_mA: float,
    kind: str,
    units: int,
    rng: np.random.Generator,
) -> Layers:
    if kind == "tanh":
        network, _ = dense.fitted(x, target, (units,), rng, _EPOCHS, _DECAY)
        return of_dense(network, unit_mA)
    found, _ = radial.fitted(x, target, units, rng, kind == "rules")
    return found.layers(unit_mA)
