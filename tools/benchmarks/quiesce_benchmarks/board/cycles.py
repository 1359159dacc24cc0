"""Cycles that instructions would take on a Cortex-M4, by their classes: estimated, not measured.

Cycles of a class are those of Arm's table for the Cortex-M4 at their worst: 2 a load or store and 1
for each further word, 12 a division, 3 a branch. The flash of an STM32F4 at 168 MHz has 5 wait
states; what runs straight on is taken as fetched ahead, and each place that a branch goes to as not
in its cache.
"""

import re
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from quiesce_benchmarks.board.disassembly import tool

WAIT_STATES = 5
# Entry and exit of an interrupt, with the fetch of its vector and of its first instruction.
INTERRUPT_CYCLES = 12 + 12 + 2 * WAIT_STATES
INSTRUCTION = re.compile(r"^\s*(?P<at>[0-9a-f]+):\t(?P<name>\S+)(?:\t(?P<operands>.*))?$", re.M)
SEVERAL = re.compile(r"^(?:push|pop|ldm\w*|stm\w*)")
BRANCH = re.compile(
    r"^(?:b|bl|blx|bx|cbz|cbnz|tbb|tbh)(?:eq|ne|cs|cc|hs|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?(?:\.[nw])?$"
)


@dataclass(frozen=True)
class Instruction:
    at: int  # address
    cycles: int
    is_branch: bool  # it may go elsewhere


def registers(operands: str) -> int:
    """In braces; a range counts as such."""
    inside = operands[operands.find("{") + 1 : operands.find("}")]
    number = 0
    for one in inside.split(","):
        first, _, last = one.strip().partition("-")
        number += int(last[1:]) - int(first[1:]) + 1 if last else 1
    return number


def read_instruction(at: int, name: str, operands: str) -> Instruction:
    writes_pc = bool(re.search(r"\bpc\b", operands)) and name.startswith(("pop", "ldm", "mov"))
    loads_pc = name.startswith("ldr") and operands.startswith("pc")
    is_branch = bool(BRANCH.match(name)) or writes_pc or loads_pc
    if SEVERAL.match(name):
        cycles = 1 + registers(operands)
    elif name.startswith(("ldrd", "strd")):
        cycles = 3
    elif name.startswith(("ldr", "str")):
        cycles = 2
    elif name.startswith(("sdiv", "udiv")):
        cycles = 12
    else:
        cycles = 1
    return Instruction(at, cycles + 2 * is_branch, is_branch)


def read_instructions(text: str) -> list[Instruction]:
    """Of what objdump -d prints, by address."""
    return [
        read_instruction(int(found["at"], 16), found["name"], found["operands"] or "")
        for found in INSTRUCTION.finditer(text)
    ]


def block_from(instructions: list[Instruction], first: int) -> Iterable[Instruction]:
    for one in instructions[first:]:
        yield one
        if one.is_branch:
            return


def cycles_of(instructions: list[Instruction], executed: dict[int, int]) -> float:
    """executed: instructions by the address that their block begins at, as `quiesce_bench count`
    profiles them. KeyError where no instruction is there."""
    addresses = [one.at for one in instructions]
    total = 0.0
    for address, number in executed.items():
        first = bisect_left(addresses, address)
        if first == len(addresses) or addresses[first] != address:
            raise KeyError(hex(address))
        block = list(block_from(instructions, first))
        times = number / len(block)
        total += times * (sum(one.cycles for one in block) + WAIT_STATES)
    return total


def estimated_cycles(image: Path, executed: dict[int, int]) -> float:
    """Of an ELF file. BenchFailure where the tools refuse it."""
    return cycles_of(
        read_instructions(tool("objdump", "-d", "--no-show-raw-insn", image)), executed
    )
