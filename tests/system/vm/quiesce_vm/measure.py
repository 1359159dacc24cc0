"""Figures of the virtual machine, for `./tools/benchmark can`."""

import math
import re
import time
from typing import Any

from quiesce.base.errors import BenchFailure

from quiesce_vm import boots
from quiesce_vm.boots import BusRun, Results, TimingRun

TICK_NS = 1_000_000  # of the timing boot: the default tick rate


def measure() -> dict[str, float]:
    """Boots twice. UsageError where the images (tests/system/vm/build_images) are not there.

    vm_frames_lost: of 10,000 each way; estop_ticks: from the line's edge to the first safe demand
    frame, the worst; vm_trace_mismatches: of the lock-step comparison; lateness_over_cyclictest:
    worst over worst; vm_seconds: for both boots.
    """
    start_s = time.monotonic()
    with boots.opened() as vm:
        bus = boots.run_bus(vm)
        timing = boots.run_timing(vm)
    return {
        "vm_frames_lost": frames_lost(bus),
        "estop_ticks": estop_ticks(timing),
        "vm_trace_mismatches": bus.lockstep["mismatches"],
        "lateness_over_cyclictest": lateness_over_cyclictest(timing.results),
        "vm_seconds": round(time.monotonic() - start_s, 1),
    }


def frames_lost(bus: BusRun) -> int:
    """Echoes that did not come back as they were, and what the guest's interface says it dropped
    or did not count, whichever is more."""
    before = _link(bus.results, "before_echo")
    after = _link(bus.results, "after_echo")
    lost = 0
    for way in ("rx", "tx"):
        counted = {name: after[way][name] - before[way][name] for name in after[way]}
        lost += counted["dropped"] + counted["errors"]
        lost += max(0, boots.ECHOES - counted["packets"])
    return max(lost, bus.echo_wrong)


def presses(timing: TimingRun) -> list[dict[str, Any]]:
    return [one for name, one in timing.results.items() if re.fullmatch(r"press\d+", name)]


def estop_ticks(timing: TimingRun) -> int:
    """Ticks, begun ones counted, from just before the edge to the first safe demand frame."""
    times_ns = [one["safe_ns"] - one["pressed_ns"] for one in presses(timing)]
    if not times_ns:
        raise BenchFailure("the guest never pressed the emergency stop")
    return max(math.ceil(time_ns / TICK_NS) for time_ns in times_ns)


def cyclictest_worst_us(results: Results) -> int:
    match = re.search(r"Max:\s*(\d+)", results["cyclictest"]["summary"])
    if match is None:
        raise BenchFailure(f"cyclictest said {results['cyclictest']['summary']!r}")
    return int(match[1])


def lateness_over_cyclictest(results: Results) -> float:
    worst_us = results["status"]["status"]["loop"]["lateness"]["worst_us"]
    return round(worst_us / cyclictest_worst_us(results), 3)


def _link(results: Results, name: str) -> dict[str, dict[str, int]]:
    return results[name]["link"][0]["stats64"]
