"""Which model to take: by validation inside the training part, then by size and passivity."""

from collections.abc import Sequence

from quiesce.damper.fitted import BLACK_BOX, PARAMETRIC, Fitted
from quiesce.damper.validation import share_before

# Validation errors this close (relative) are a tie, which a model wins that is much smaller.
TIE = 0.02
# At most this part of the numbers of the one with the least error is much smaller.
MUCH_SMALLER = 2.0 / 3.0


def ranked(models: Sequence[Fitted]) -> list[Fitted]:
    """Best first. Among models whose validation errors lie within TIE of the best of those left,
    one that is much smaller than that comes first, the smallest of them where there are several."""
    left = sorted(models, key=lambda one: one.validation_error)
    out: list[Fitted] = []
    while left:
        limit = left[0].validation_error * (1.0 + TIE)
        most = MUCH_SMALLER * left[0].parameter_count
        small = [
            one for one in left if one.validation_error <= limit and one.parameter_count <= most
        ]
        first = min(small, key=by_size) if small else left[0]
        out.append(first)
        left.remove(first)
    return out


def by_size(one: Fitted) -> tuple[int, float]:
    return one.parameter_count, one.validation_error


def best(models: Sequence[Fitted]) -> dict[str, Fitted]:
    """The winners: "parametric", "passive" (proved, not only in trials) and "black box", as far as
    there are any."""
    order = ranked(models)
    groups = {
        PARAMETRIC: [one for one in order if one.kind == PARAMETRIC],
        "passive": [one for one in order if one.kind == PARAMETRIC and one.passivity.is_proved],
        BLACK_BOX: [one for one in order if one.kind == BLACK_BOX],
    }
    return {name: group[0] for name, group in groups.items() if group}


def sureness(order: Sequence[Fitted]) -> list[float | None]:
    """For each model the part of redrawn validations in which the first one has the smaller error;
    None for itself and where it cannot be told."""
    return [
        None if k == 0 else share_before(order[0].folds, one.folds) for k, one in enumerate(order)
    ]
