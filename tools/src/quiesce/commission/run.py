"""Steps one after the other, from the first that is not done."""

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.commission.by_hand import to_play
from quiesce.commission.folder import STATE, Folder
from quiesce.commission.simulated import TABLE, limit_mA
from quiesce.commission.site import Site
from quiesce.commission.steps import NAMES, STEPS, excite, wiring
from quiesce.commission.wants import Wants, same, wants_of
from quiesce.commission.work import RECORDING, Work

Tell = Callable[[str], None]
OpenSite = Callable[[Wants, Folder], Site]


@dataclass(frozen=True)
class Order:
    """begin: the step to go back to; end: the last one to do; None: all that are left."""

    folder: Path
    given: Mapping[str, Any]  # of Wants, what is said now; the folder has the others
    begin: str | None
    end: str | None
    is_fresh: bool


def commission(order: Order, tell: Tell, open_site: OpenSite, told: Tell) -> Folder:
    """open_site: where it is done; entered for a step that needs it. told: each result's line.
    UsageError for what cannot be wanted, BenchFailure where a step fails, Left where he leaves: the
    steps before it stay done."""
    folder, wants = begun(order)
    last = NAMES.index(order.end) if order.end else len(STEPS) - 1
    lines: list[tuple[str, str]] = []
    for number, step in enumerate(STEPS[: last + 1], 1):
        if step.NAME in folder.results:
            lines.append((step.TITLE, told_of(step, folder)))
            continue
        tell(f"{number}/{len(STEPS)} {step.TITLE}")
        with ExitStack() as stack:  # a rig is there for a step that asks for it, and no longer

            def opened(stack: ExitStack = stack) -> Site:
                return stack.enter_context(open_site(wants, folder))

            result = step.run(Work(wants, folder, tell, opened, lines))
        folder.done(step.NAME, result)
        lines.append((step.TITLE, step.line(result)))
        told(f"{step.NAME:10s} {lines[-1][1]}")
    return folder


def begun(order: Order) -> tuple[Folder, Wants]:
    """UsageError where the folder was begun for something else, or for nothing yet: it stays as it
    is then."""
    old = Folder(order.folder) if not order.is_fresh else None
    is_new = old is None or not old.wants
    if is_new and not order.given:
        raise UsageError(
            f"{shown(order.folder)}: nothing is begun there; name what to begin with: --sim "
            "PLANT.toml, or --max-current A and --drive V of a rig on a bus"
        )
    before = Wants() if old is None or is_new else wants_of(old.wants)
    wants = replace(before, **order.given)
    require_whole(wants)
    first = NAMES.index(order.begin) if order.begin is not None else len(NAMES)
    if is_new and order.begin is not None and first > 0:
        raise UsageError(f"--from {order.begin}: {NAMES[0]} is not done yet")
    if not is_new and order.begin is None:
        same(before, wants)
    if is_new:
        for name in (STATE, TABLE, wiring.BEFORE):
            (order.folder / name).unlink(missing_ok=True)
    folder = Folder(order.folder)
    if order.begin is not None:
        if missing := [one for one in NAMES[:first] if one not in folder.results]:
            raise UsageError(f"--from {order.begin}: {missing[0]} is not done yet")
        folder.forget(list(NAMES[first:]))
    if is_new or first <= NAMES.index(excite.NAME):
        for name in (excite.LOOK, RECORDING):
            to_play(order.folder, name).unlink(missing_ok=True)
    folder.wants = wants.data()
    folder.save()
    return folder, wants


def require_whole(wants: Wants) -> None:
    """UsageError where that cannot be wanted together, or is not enough: of what is real somebody
    has to say what it carries."""
    if wants.plant is not None:
        limit_mA(wants)
        return
    if wants.start:
        raise UsageError("--set is of the simulated controller; give --sim, too")
    if wants.max_current_A is None:
        raise UsageError("what may coil and driver carry? --max-current A")


def listed(folder: Folder) -> list[tuple[str, str]]:
    """Every step, what came of it; empty: nothing yet. UsageError where that is not whole."""
    return [(one.NAME, told_of(one, folder) if one.NAME in folder.results else "") for one in STEPS]


def told_of(step: ModuleType, folder: Folder) -> str:
    """What came of a step, in a line. UsageError where what its file says is not whole."""
    try:
        return str(step.line(folder.results[step.NAME]))
    except (KeyError, TypeError, ValueError, IndexError, AttributeError):
        raise UsageError(
            f"{shown(folder.file)}: what came of {step.NAME} is not whole; --from {step.NAME} does "
            "it again"
        )
