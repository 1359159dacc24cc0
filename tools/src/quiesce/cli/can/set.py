"""`quiesce can set NAME=VALUE...`: parameters of a controller at work."""

import argparse
import sys
from collections.abc import Mapping
from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.cli.can.bus_options import add_bus_options, bus_of

EPILOG = """examples:
  quiesce can set law=phase --bus socketcan:can0
  quiesce can set law=constant constant_current_mA=1500 --save --bus slcan:/dev/ttyACM0

All values go into effect together, or none: they are staged, applied (the controller goes to its
safe current, then starts from rest), read back and compared with the hash that it reports. Where
anything fails, what was staged is discarded. --save keeps them for the next start, too.
Exit codes: 1 the controller refused or did not answer, 2 a value that is not allowed.
"""

APPLY_S = 3.0
SAVE_S = 10.0
HASH_S = 3.0


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "set",
        help="change parameters, checked by reading back",
        description="Change parameters of the controller, all of them or none.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("settings", nargs="+", metavar="NAME=VALUE")
    parser.add_argument("--save", action="store_true", help="keep them for the next start")
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.parameters import name_of, parameters, settings_of, text_of
    from quiesce.can.services import Services

    settings = settings_of(args.settings)
    with Link(bus_of(args)) as link:
        services = Services(link, load())
        before = services.read_all()
        apply(services, settings)
        verify(services, before, settings)
        for index, value in settings.items():
            one = parameters()[index]
            print(f"{name_of(index)}: {text_of(one, before[index])} -> {text_of(one, value)}")
        if args.save:
            save(services)
    return 0


def apply(services: Any, settings: Mapping[int, int]) -> None:
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


def must(reply: Any, services: Any, operation: str) -> None:
    """BenchFailure, with what would be allowed, unless the reply is DONE."""
    from quiesce.can.services import DONE, no_answer

    if reply is None:
        raise BenchFailure(
            f"{no_answer(services.link)} ({operation}; what was staged is discarded)"
        )
    if reply.result != DONE:
        raise BenchFailure(f"refused: {why_refused(reply, operation)}; nothing was changed")


def why_refused(reply: Any, operation: str) -> str:
    from quiesce.can.parameters import name_of, parameters
    from quiesce.engine.params import expected

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


def verify(services: Any, before: list[int], settings: Mapping[int, int]) -> None:
    """BenchFailure where the controller has other values, or tells another hash."""
    from quiesce.can.parameters import hash_of, name_of

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


def save(services: Any) -> None:
    from quiesce.can.services import DONE

    reply = services.ask("SAVE", reply_s=SAVE_S, tries=2)
    if reply is None or reply.result != DONE:
        reason = "no reply" if reply is None else reply.result
        raise BenchFailure(f"in effect, but not stored for the next start: {reason}")
    print("stored for the next start", file=sys.stderr)
