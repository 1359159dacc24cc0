"""Which model to take: by validation inside the training part, then by size and passivity."""

from collections.abc import Sequence

from quiesce.damper.fitted import BLACK_BOX, PARAMETRIC, Fitted

# Validation errors this close (relative) are a tie, which the smaller model wins.
TIE = 0.02


def ranked(models: Sequence[Fitted]) -> list[Fitted]:
    """Best first. Among models whose validation errors lie within TIE of the best of those left,
    the one with the fewest fitted numbers comes first."""
    left = sorted(models, key=lambda one: one.validation_error)
    out: list[Fitted] = []
    while left:
        limit = left[0].validation_error * (1.0 + TIE)
        tied = [one for one in left if one.validation_error <= limit]
        first = min(tied, key=lambda one: (one.parameter_count, one.validation_error))
        out.append(first)
        left.remove(first)
    return out


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
