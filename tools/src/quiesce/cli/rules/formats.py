"""Options that say in which integers a rule base is compiled: shared by compile and check."""

import argparse
from collections.abc import Callable
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.rules.controller import controller_form
from quiesce.rules.engine.precise import GOOD, Precise, compile_precisely, judged
from quiesce.rules.formats.build import NotPlain
from quiesce.rules.formats.files import read_rules, read_system
from quiesce.rules.integers.compile import Q15, Q16, compile_base
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.controller import compile_for_controller
from quiesce.rules.model import RuleBase
from quiesce.rules.straight.compile import NotStraight, compile_straight
from quiesce.rules.surface.compile import Surface
from quiesce.rules.system.model import System

FORMATS_HELP = """integers:
  Without --lsb an input is q15, 0..32768 over its universe, and an output q16, 0..65536. With
  --lsb NAME=X they count X of the variable's own unit from 0. --controller takes what the firmware
  has: uHz, um/s2 and mA, from a file in Hz, m/s2 and A.
"""

ENGINE_TAKEN = "taken: the engine for any system, not the fast one"
MUCH_BETTER = 0.7  # of an error, so that another form is worth its instructions


def add_file_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", metavar="FILE", type=Path, help="rule file (.fcl, .fll, .fis, .t2fis)"
    )
    parser.add_argument(
        "--lsb",
        action="append",
        default=[],
        metavar="NAME=X",
        help="what one count of a variable is",
    )
    parser.add_argument(
        "--controller", action="store_true", help="the integers of the controller: uHz, um/s2, mA"
    )
    parser.add_argument(
        "--default", action="append", default=[], metavar="NAME=X",
        help="output where no rule fires, if the file does not say",
    )  # fmt: skip
    parser.add_argument(
        "--approximate", type=int, metavar="N", help="smooth sets as chains of N straight segments"
    )


def compiled_from(args: argparse.Namespace) -> CompiledBase:
    base = read_rules(args.file, args.approximate)
    if args.controller:
        require_one_scale(args)
        return compile_for_controller(base, defaults(args, base))
    named = assignments("--lsb", args.lsb, base)
    inputs = [named.get(variable.name, Q15) for variable in base.inputs]
    outputs = [named.get(variable.name, Q16) for variable in base.outputs]
    return compile_base(base, inputs, outputs, defaults(args, base))


def require_one_scale(args: argparse.Namespace) -> None:
    if args.lsb:
        raise UsageError("--controller and --lsb exclude each other")


def any_compiled_from(args: argparse.Namespace) -> tuple[CompiledBase | Precise | Surface, str]:
    """A plain base, or a system in the form that suits it, and why; empty for a plain base."""
    if args.controller:
        require_one_scale(args)
        given = defaults(args, read_system(args.file)) if args.default else None
        return controller_form(args.file, args.approximate, given)
    return _compiled_or(args, system_from)


def plain_or_table_from(args: argparse.Namespace) -> tuple[CompiledBase | Precise, str]:
    """A plain base, or a table of the engine for any system, and why it is no plain base."""
    return _compiled_or(args, lambda args: (compile_precisely(*forms_from(args)), ""))


def _compiled_or(
    args: argparse.Namespace, other: Callable[[argparse.Namespace], tuple[Precise, str]]
) -> tuple[CompiledBase | Precise, str]:
    try:
        return compiled_from(args), ""
    except NotPlain as reason:
        if args.approximate is not None:
            raise
        if args.controller:
            raise UsageError(
                f"{reason}; a controller takes the surface of its answers: 'quiesce rules compile "
                "--controller' says how near that is, 'quiesce rules check' without --controller "
                "checks the rules"
            )
        found, taken = other(args)
        return found, "; ".join(filter(None, (str(reason), taken)))


def system_from(args: argparse.Namespace) -> tuple[Precise, str]:
    """Straight-line C where the system has that form and it answers well; and what was taken."""
    forms = forms_from(args)
    if args.table:
        return compile_precisely(*forms), ENGINE_TAKEN
    try:
        straight = judged(compile_straight(*forms))
    except NotStraight as reason:
        return compile_precisely(*forms), f"no straight-line C: {reason}; {ENGINE_TAKEN}"
    if straight.error > GOOD:
        table = compile_precisely(*forms)
        if table.error < MUCH_BETTER * straight.error:
            off = f"{100.0 * straight.error:.2g} % of an output's range off"
            return table, f"straight-line C would be {off}; {ENGINE_TAKEN}"
    return straight, "taken: straight-line C of polynomials"


def forms_from(
    args: argparse.Namespace,
) -> tuple[System, list[float | str], list[float | str], dict[str, float]]:
    """The system, its inputs' and outputs' integers, and what an output is where nothing fires."""
    system = read_system(args.file)
    named = assignments("--lsb", args.lsb, system)
    inputs = [named.get(variable.name, Q15) for variable in system.inputs]
    outputs = [named.get(variable.name, Q16) for variable in system.outputs]
    return system, inputs, outputs, defaults(args, system)


def defaults(args: argparse.Namespace, base: RuleBase | System) -> dict[str, float]:
    named = assignments("--default", args.default, base)
    for output in base.outputs:
        if output.name in named and output.default is not None:
            raise UsageError(f"--default {output.name}: the file says {output.default:g}")
    wrong = set(named) - {output.name for output in base.outputs}
    if wrong:
        raise UsageError(f"--default {sorted(wrong)[0]}: not an output of {base.name}")
    return named


def assignments(option: str, texts: list[str], base: RuleBase | System) -> dict[str, float]:
    known = [variable.name for variable in (*base.inputs, *base.outputs)]
    found: dict[str, float] = {}
    for text in texts:
        name, sign, number = text.partition("=")
        if not sign or name not in known:
            raise UsageError(f"{option} {text}: NAME=NUMBER, NAME one of {', '.join(known)}")
        if name in found:
            raise UsageError(f"{option} {name}: given twice")
        try:
            found[name] = float(number)
        except ValueError:
            raise UsageError(f"{option} {text}: {number!r} is not a number") from None
    return found
