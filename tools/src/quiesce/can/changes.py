"""Changes of parameters of a controller at work: all of them or none, read back, stored."""

from collections.abc import Mapping

from quiesce.base.errors import BenchFailure
from quiesce.can.parameters import hash_of, name_of, parameters
from quiesce.can.services import DONE, Reply, Services, no_answer
from quiesce.engine.params import expected

APPLY_S = 3.0
SAVE_S = 10.0
HASH_S = 3.0


def apply(services: Services, settings: Mapping[int, int]) -> None:
    """Stages and applies. BenchFailure, and nothing is staged or changed, where that fails."""
    is_applied = False
    try:
        must(services.ask("DISCARD"), services, "DISCARD")
        for index, value in settings.items():
            must(services.ask("STAGE", index, value), services, "STAGE")
        must(services.ask("APPLY", reply_s=APPLY_S), services, "APPLY")
        is_applied = True
    finally:
        if not is_applied:
            services.ask("DISCARD")


def must(reply: Reply | None, services: Services, operation: str) -> None:
    """BenchFailure, with what would be allowed, unless the reply is DONE."""
    if reply is None:
        raise BenchFailure(
            f"{no_answer(services.link)} ({operation}; what was staged is discarded)"
        )
    if reply.result != DONE:
        raise BenchFailure(f"refused: {why_refused(reply, operation)}; nothing was changed")


def why_refused(reply: Reply, operation: str) -> str:
    name, known = name_of(reply.param_index), parameters()
    if reply.result == "FAULT_IS_LATCHED":
        return "the controller is in a latched fault; acknowledge that first"
    if reply.result == "IS_ARMED":
        return f"the controller is armed, and {name} may not change then; disarm it first"
    if reply.result == "NO_SUCH_PARAMETER":
        return f"this controller's firmware has no parameter {name}"
    if reply.result in ("OUT_OF_RANGE", "CONTRADICTION") and reply.param_index < len(known):
        is_alone = reply.result == "OUT_OF_RANGE"
        why = "is out of its range" if is_alone else "contradicts another parameter"
        allowed = expected(known[reply.param_index])
        return f"{name} {why}; it is {allowed} (docs/reference/parameters.md)"
    return f"{operation} of {name}: {reply.result}"


def verify(services: Services, before: list[int], settings: Mapping[int, int]) -> None:
    """BenchFailure where the controller has other values, or tells another hash."""
    after = services.read_all()
    wanted = [settings.get(index, value) for index, value in enumerate(before)]
    for index, (value, want) in enumerate(zip(after, wanted, strict=True)):
        if value != want:
            raise BenchFailure(f"{name_of(index)} is {value} after it was applied, not {want}")
    if not services.wait_hash(hash_of(wanted), HASH_S):
        raise BenchFailure(
            "the values are in effect, but the controller's Identification does not tell their "
            f"hash {hash_of(wanted):08X}; is its firmware of another version?"
        )


def save(services: Services) -> None:
    """What is in effect, for the next start. BenchFailure where it is not stored."""
    reply = services.ask("SAVE", reply_s=SAVE_S, tries=2)
    if reply is None or reply.result != DONE:
        reason = "no reply" if reply is None else reply.result
        raise BenchFailure(f"in effect, but not stored for the next start: {reason}")
