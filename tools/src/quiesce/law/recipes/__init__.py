"""Published laws as recipes: one file and one line each."""

from quiesce.base.errors import UsageError
from quiesce.base.nearest import listed
from quiesce.law.recipe import Recipe
from quiesce.law.recipes import (
    add,
    backstepping,
    bang_bang,
    bilinear,
    clipped_linear,
    clipped_optimal,
    fuzzy_drift,
    fuzzy_skyhook,
    groundhook,
    groundhook_on_off,
    lyapunov,
    max_dissipation,
    mixed_hooks,
    modulated_friction,
    pid_sliding,
    polynomial,
    quasi_bang_bang,
    sh_add,
    skyhook,
    skyhook_elastomer,
    skyhook_on_off,
    sliding_mode,
    tsk,
)

RECIPES: tuple[Recipe, ...] = (
    clipped_optimal.RECIPE,
    clipped_linear.RECIPE,
    skyhook.RECIPE,
    groundhook.RECIPE,
    mixed_hooks.RECIPE,
    sliding_mode.RECIPE,
    pid_sliding.RECIPE,
    backstepping.RECIPE,
    modulated_friction.RECIPE,
    skyhook_on_off.RECIPE,
    groundhook_on_off.RECIPE,
    add.RECIPE,
    sh_add.RECIPE,
    lyapunov.RECIPE,
    bang_bang.RECIPE,
    quasi_bang_bang.RECIPE,
    max_dissipation.RECIPE,
    polynomial.RECIPE,
    skyhook_elastomer.RECIPE,
    fuzzy_skyhook.RECIPE,
    fuzzy_drift.RECIPE,
    tsk.RECIPE,
    bilinear.RECIPE,
)


def find(name: str) -> Recipe:
    """UsageError, with those that there are, where there is none of that name."""
    for recipe in RECIPES:
        if recipe.name == name:
            return recipe
    raise UsageError(f"no recipe '{name}'; {listed(name, (one.name for one in RECIPES))}")
