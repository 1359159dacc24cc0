"""Second boot: virtual time that follows the instructions. What the kernel's time stamps say of an
emergency stop, how late ticks begin beside cyclictest, and that all of it comes out the same again.

Virtual time knows no caches and no memory: none of these figures is one of real hardware.
"""

from quiesce_vm import boots
from quiesce_vm.boots import TimingRun, Vm
from quiesce_vm.measure import (
    TICK_NS,
    cyclictest_worst_us,
    estop_ticks,
    lateness_over_cyclictest,
    presses,
)


def test_two_boots_print_the_same(vm: Vm, timing: TimingRun) -> None:
    assert boots.run_timing(vm).text.splitlines() == timing.text.splitlines()


def test_emergency_stop_takes_two_ticks_at_the_most(timing: TimingRun) -> None:
    assert len(presses(timing)) == 16
    assert len({one["pressed_ns"] % TICK_NS // (TICK_NS // 16) for one in presses(timing)}) >= 12
    assert estop_ticks(timing) <= 2
    assert {one["current_mA"] for one in presses(timing)} == {300}
    assert max(one["late_frames"] for one in presses(timing)) <= 1


def test_edges_that_the_controller_logged_are_the_presses(timing: TimingRun) -> None:
    assert len(timing.edges_ns) >= len(presses(timing)) // 2  # a level may be seen before its edge
    spans = [(one["pressed_ns"], one["safe_ns"]) for one in presses(timing)]
    for edge_ns in timing.edges_ns:
        assert any(pressed <= edge_ns <= safe for pressed, safe in spans), edge_ns


def test_ticks_begin_about_as_late_as_those_of_cyclictest(timing: TimingRun) -> None:
    loop = timing.results["status"]["status"]["loop"]
    assert loop["ticks"] >= 1000
    assert loop["overruns"] == 0
    assert cyclictest_worst_us(timing.results) > 0
    assert lateness_over_cyclictest(timing.results) <= 1.5


def test_histograms_hold_every_tick(timing: TimingRun) -> None:
    loop = timing.results["status"]["status"]["loop"]
    for kind in ("lateness", "work"):
        assert sum(loop[kind]["below_us"].values()) == loop[kind]["count"] >= loop["ticks"]
        assert loop[kind]["worst_us"] < max(int(bound) for bound in loop[kind]["below_us"])
    assert loop["work"]["worst_us"] < TICK_NS / 1000


def test_this_boot_runs_on_libgpiod_2(timing: TimingRun) -> None:
    assert timing.results["timing"]["code"] == 0
    assert "libgpiod 2." in timing.results["timing"]["said"]
