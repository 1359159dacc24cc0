"""Flash, memory, stack and instructions of the image with what a board has to have."""

import subprocess
import sys
from pathlib import Path
from typing import Any

from quiesce.base.paths import build_folder
from quiesce.base.table import format_table
from quiesce.engine.bench import Bench, require_file
from quiesce.engine.scenarios import find_file, names, read_toml

from quiesce_benchmarks.board.cycles import INTERRUPT_CYCLES, estimated_cycles
from quiesce_benchmarks.board.disassembly import PREFIX, tool
from quiesce_benchmarks.images import count
from quiesce_benchmarks.part import Effort, Measured

TITLE = "budget: an image for a Cortex-M4, -O2, with the fuzzy and the phase laws"
FIGURES = (
    ("flash_kB", "kB", 80.0, "lower"),
    ("ram_kB", "kB", 40.0, "lower"),
    ("stack_B", "byte", 2048.0, "lower"),
    ("tick_stack_B", "byte", None, "lower"),
    ("tick_worst_instr", "instr", 4200.0, "lower"),
    ("node_tick_worst_instr", "instr", None, "lower"),
    ("isr_worst_instr", "instr", 120.0, "lower"),
    ("isr_stack_B", "byte", None, "lower"),
    ("cpu_pct_168MHz", "%", 15.0, "lower"),
)
# By their number in parameters.toml, whose labels are only ever appended to.
LAWS = {"fuzzy": 2, "fuzzy_selftune": 3, "phase": 4}
NODE_TICK = 2  # what node_cost counts
TICKS, QUICK_TICKS = 20000, 4000
ISR_STEPS, QUICK_ISR_STEPS = 100_000, 20_000
CLOCK_Hz, TICK_Hz, ISR_Hz = 168e6, 1000, 10_000
SECTIONS = (".text", ".data", ".bss", ".noinit", ".stack")


def section_bytes(image: str) -> dict[str, int]:
    """By name, 0 where there is none."""
    rows = [line.split() for line in tool("size", "-A", image).splitlines()]
    sizes = {row[0]: int(row[1]) for row in rows if len(row) == 3 and row[1].isdigit()}
    return {name: sizes.get(name, 0) for name in SECTIONS}


def node_counts(bench: Bench, ticks: int) -> dict[str, dict[str, Any]]:
    """Of the node's tick, by law: messages, tables and records beside the controller."""
    file = build_folder() / "budget/tests/unit/mps2/node_cost.elf"
    image = require_file(file, "the image")
    return {law: count(bench, image, NODE_TICK, ticks, 1 + i) for law, i in LAWS.items()}


def scenario_worst(bench: Bench, law: str, is_quick: bool) -> int:
    """Worst tick of the controller over the scenarios of one sensor and one damper."""
    image = require_file(build_folder() / "budget/targets/mps2/quiesce_mps2_shm.elf", "the image")
    plugin = build_folder() / "host/sim_hil/icount_plugin.so"
    target = ["--target", "mps2", "--image", str(image), "--plugin", str(plugin)]
    files = [find_file(name) for name in names()]
    files = [file for file in files if "board" not in read_toml(file)]
    worst = 0
    for file in files[:: 4 if is_quick else 1]:
        # The one tracker of this build.
        run = ["--scenario", str(file), "--law", law, "--seeds", "1", "--set", "tracker=compare"]
        worst = max(worst, bench.json("compare", *run, *target)["instr_worst"])
    print(f"board: law {law}: worst tick {worst} instructions", file=sys.stderr, flush=True)
    return worst


def worst_pass_cycles(bench: Bench, image: Path, found: dict[str, Any], *words: int) -> float:
    """Estimated, of the worst pass that a count of the same words found."""
    told = count(bench, image, *words, profile=str(found["worst_pass"]))["profile"]
    return estimated_cycles(image, {int(address): number for address, number in told.items()})


def interrupt_counts(bench: Bench, steps: int) -> dict[str, Any]:
    """Of the current loop's step, the worse one of both bridges; its cycles are an estimate."""
    file = build_folder() / "budget/tools/benchmarks/current_cost.elf"
    image = require_file(file, "the image")
    found = {bridge: count(bench, image, steps, bridge) for bridge in (0, 1)}
    bridge = max(found, key=lambda one: found[one]["worst"])
    worst = found[bridge]
    return {
        "worst": worst["worst"],
        "median": worst["median"],
        "stack_B": worst["printed"]["stack_bytes"],
        "cycles": worst_pass_cycles(bench, image, worst, steps, bridge),
    }


def node_cycles(bench: Bench, counts: dict[str, dict[str, Any]], ticks: int) -> float:
    """Estimated, of the worst tick of the law whose worst one has most instructions."""
    law = max(counts, key=lambda one: counts[one]["worst"])
    image = build_folder() / "budget/tests/unit/mps2/node_cost.elf"
    return worst_pass_cycles(bench, image, counts[law], NODE_TICK, ticks, 1 + LAWS[law])


def share_pct(tick_cycles: float, isr_cycles: float) -> float:
    """Of the processor, with every tick and every interrupt the worst one."""
    tick_Hz_cycles = (tick_cycles + INTERRUPT_CYCLES) * TICK_Hz
    return 100.0 * (tick_Hz_cycles + (isr_cycles + INTERRUPT_CYCLES) * ISR_Hz) / CLOCK_Hz


def compiler() -> str:
    told = subprocess.run([PREFIX + "gcc", "--version"], capture_output=True, text=True, check=True)
    return told.stdout.splitlines()[0]


def measure(effort: Effort) -> Measured:
    bench = Bench()
    node = build_folder() / "budget/targets/mps2/quiesce_mps2_node.elf"
    sizes = section_bytes(str(require_file(node, "the image")))
    ticks = QUICK_TICKS if effort.is_quick else TICKS
    counts = node_counts(bench, ticks)
    tick_cycles = node_cycles(bench, counts, ticks)
    isr = interrupt_counts(bench, QUICK_ISR_STEPS if effort.is_quick else ISR_STEPS)
    worst = {law: scenario_worst(bench, law, effort.is_quick) for law in LAWS}
    tick_stack = max(one["printed"]["stack_bytes"] for one in counts.values())
    rest_stack = max(one["printed"]["rest_stack_bytes"] for one in counts.values())
    flash = sizes[".text"] + sizes[".data"]
    ram = sizes[".data"] + sizes[".bss"] + sizes[".noinit"] + sizes[".stack"]
    values: dict[str, float | None] = {
        "flash_kB": flash / 1000.0,
        "ram_kB": ram / 1000.0,
        "stack_B": max(tick_stack, rest_stack),
        "tick_stack_B": tick_stack,
        "tick_worst_instr": max(worst.values()),
        "node_tick_worst_instr": max(one["worst"] for one in counts.values()),
        "isr_worst_instr": isr["worst"],
        "isr_stack_B": isr["stack_B"],
        "cpu_pct_168MHz": share_pct(tick_cycles, isr["cycles"]),
    }
    laws = {
        law: {
            "tick_worst_instr": worst[law],
            "node_tick_worst_instr": counts[law]["worst"],
            "node_tick_median_instr": counts[law]["median"],
            "tick_stack_B": counts[law]["printed"]["stack_bytes"],
        }
        for law in LAWS
    }
    head = ["law", "worst tick", "worst tick of the node", "its median", "stack of a tick, bytes"]
    table = format_table(head, [[law, *row.values()] for law, row in laws.items()])
    cycles = {"node_tick": round(tick_cycles), "isr": round(isr["cycles"])}
    reported = {"laws": laws, "sections": sizes, "compiler": compiler(), "cycles": cycles}
    return Measured(values, reported, (table,))
