"""`./tools/benchmark board`: its parts find what they are to find."""

import stat
from pathlib import Path

import pytest
from quiesce.base.errors import BenchFailure, UsageError
from quiesce_benchmarks.board.cycles import (
    INTERRUPT_CYCLES,
    WAIT_STATES,
    cycles_of,
    read_instructions,
)
from quiesce_benchmarks.board.disassembly import read_graph
from quiesce_benchmarks.board.parts import bits, coil, flash, resources
from quiesce_benchmarks.board.parts.budget import share_pct
from quiesce_benchmarks.board.parts.path import DIVISION, FORBIDDEN
from quiesce_benchmarks.part import Effort

DISASSEMBLY = """
00000100 <tick>:
     100:\tpush\t{r4, lr}
     102:\tbl\t200 <divides>
     106:\tbeq.n\t10a <tick+0xa>
     108:\tb.w\t300 <tail>

00000200 <divides>:
     200:\tb.n\t400 <__aeabi_uldivmod>

00000300 <tail>:
     300:\tblx\tr3
     302:\tbx\tlr

00000400 <__aeabi_uldivmod>:
     400:\tbx\tlr

00000500 <by_pointer>:
     500:\tbl\t600 <deep>

00000600 <deep>:
     600:\tbx\tlr

00000700 <never>:
     700:\tbx\tlr
"""
QUICK = Effort(1, True, Path())


def test_calls_jumps_and_pointers_are_followed() -> None:
    graph = read_graph(DISASSEMBLY, [0x501])
    reached = graph.reachable("tick")
    assert reached == {"tick", "divides", "tail", "__aeabi_uldivmod", "by_pointer", "deep"}
    assert graph.callers("__aeabi_uldivmod", reached) == ["divides"]


def test_a_return_is_no_call_through_a_pointer() -> None:
    assert "never" not in read_graph(DISASSEMBLY, [0x501, 0x701]).reachable("divides")


def test_an_entry_that_is_not_there_is_told() -> None:
    with pytest.raises(BenchFailure, match="no function tock"):
        read_graph(DISASSEMBLY, []).reachable("tock")


@pytest.mark.parametrize(
    "name", ["__aeabi_fadd", "__aeabi_d2iz", "__muldf3", "malloc", "_printf_r"]
)
def test_what_no_tick_may_call(name: str) -> None:
    assert FORBIDDEN.fullmatch(name)


@pytest.mark.parametrize("name", ["__aeabi_uldivmod", "__aeabi_idiv", "__udivmoddi4", "__divdi3"])
def test_division_is_known(name: str) -> None:
    assert DIVISION.fullmatch(name)
    assert not FORBIDDEN.fullmatch(name)


@pytest.mark.parametrize("name", ["memcpy", "drive_init", "divide", "free_running"])
def test_others_are_none(name: str) -> None:
    assert not DIVISION.fullmatch(name)
    assert not FORBIDDEN.fullmatch(name)


def test_recorded_traces_are_those_without_a_plant() -> None:
    lines = bits.recorded_lines("golden_streams")
    assert lines[0].startswith("columns ")
    assert len(lines) > 100
    assert not any(line.startswith(("loops/", "#")) for line in lines)


def test_a_target_whose_traces_differ_is_not_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    def printed(preset: str, program: str) -> list[str]:
        lines = bits.recorded_lines(program)
        if preset == "m32":
            lines[-1] = lines[-1][:-1] + ("0" if lines[-1][-1] != "0" else "1")
        if preset == "rv32":
            raise UsageError("build/rv32 is not there")
        return lines

    monkeypatch.setattr(bits, "printed_lines", printed)
    found = bits.measure(QUICK)
    assert found.values == {"same_bits_targets": len(bits.TARGETS) - 2}
    shas = found.reported["sha256"]
    assert shas["host"] == found.reported["recorded_sha256"]
    assert shas["m32"] not in (shas["host"], shas["rv32"])
    assert shas["rv32"] == "build/rv32 is not there"


def test_a_build_that_is_absent_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(bits, "build_folder", lambda: tmp_path)
    with pytest.raises(UsageError, match="build/rv32 is not there"):
        bits.command_of("rv32", "golden_fft")


def test_both_pipes_are_read_and_a_failure_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    program = tmp_path / "golden_fft"
    program.write_text("#!/bin/sh\necho traces >&2\nexit $1\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(bits, "command_of", lambda *_: [str(program)])
    assert bits.printed_lines("m3", "golden_fft") == ["traces"]
    program.write_text("#!/bin/sh\nexit 99\n")
    with pytest.raises(BenchFailure, match="m3: golden_fft ended with"):
        bits.printed_lines("m3", "golden_fft")


LISTING = """   text\t   data\t    bss\t    dec\t    hex\tfilename
    100\t      4\t     50\t    154\t     9a\tlaw_off.c.obj (ex build/libquiesce_core_1x1.a)
     10\t      0\t      0\t     10\t      a\tadapt.c.obj (ex build/libquiesce_core_1x1.a)
     20\t      0\t      0\t     20\t     14\trms.c.o (ex build/libquiesce_core_1x1.a)
"""


def test_bytes_belong_to_their_law_or_block() -> None:
    names = {"law_off": "law off", "adapt": "law/phase", "rms": "sense"}
    expected = {"all": 134, "law off": 104, "law/phase": 10, "sense": 20}
    assert resources.sizes_of(LISTING, names) == expected


def test_every_source_has_a_group_of_its_own() -> None:
    groups = resources.groups()
    assert groups["law_phase"] == "law phase"
    assert groups["adapt"] == "law/phase"
    assert groups["rms"] == "sense"
    files = list((resources.root() / "firmware").rglob("*.c"))
    assert len({file.stem for file in files}) == len(files)


def test_growth_is_the_largest_cell() -> None:
    before = {"law off": {"m3": 1000, "rv32": 10}, "gone": {"m3": 5}}
    found = {"law off": {"m3": 1020, "rv32": 20}, "new": {"m3": 9}}
    assert resources.growth_pct(found, before) == pytest.approx(5.0)  # 10 bytes of 200
    assert resources.growth_pct(found, {}) is None


CODE = """
00000100 <step>:
     100:\tpush\t{r4, r5, lr}
     102:\tldr\tr3, [r0, #4]
     104:\tsdiv\tr3, r3, r1
     108:\tbne.n\t100 <step>
     10a:\tadds\tr0, #1
     10c:\tbic.w\tr0, r0, #1
     110:\tldmia.w\tsp!, {r4-r6, pc}
"""


def test_classes_of_instructions_have_their_cycles() -> None:
    found = read_instructions(CODE)
    assert [one.cycles for one in found] == [4, 2, 12, 3, 1, 1, 7]
    assert [one.is_branch for one in found] == [False, False, False, True, False, False, True]


def test_a_block_counts_as_often_as_it_ran_with_its_wait_states() -> None:
    found = read_instructions(CODE)
    first, second = 21 + WAIT_STATES, 9 + WAIT_STATES
    assert cycles_of(found, {0x100: 4, 0x10A: 3}) == first + second
    assert cycles_of(found, {0x100: 8}) == 2 * first
    with pytest.raises(KeyError, match="0x106"):
        cycles_of(found, {0x106: 1})


def test_share_is_of_ticks_and_interrupts() -> None:
    assert share_pct(168e3 - INTERRUPT_CYCLES, -INTERRUPT_CYCLES) == pytest.approx(100.0)
    assert share_pct(-INTERRUPT_CYCLES, 16.8e3 - INTERRUPT_CYCLES) == pytest.approx(100.0)


def coil_step(is_possible: bool, step_ms: float, bound_ms: float) -> dict[str, float | bool]:
    return {
        "supply_V": 12.0,
        "resistance_ohm": 5.0,
        "inductance_mH": 20.0,
        "is_possible": is_possible,
        "step_ms": step_ms,
        "bound_ms": bound_ms,
        "overshoot_pct": step_ms / 10.0,
        "steady_pct": 0.01,
    }


def test_coils_beyond_the_supply_are_counted_and_have_no_step() -> None:
    found = [coil_step(True, 8.0, 5.0), coil_step(True, 12.0, 11.5), coil_step(False, 99.0, 0.0)]
    values = coil.figures_of(found)
    assert values["current_step_ms_worst"] == 12.0
    assert values["current_step_bound_ms_worst"] == 11.5
    assert values["current_step_beyond_bound_ms_worst"] == 3.0
    assert values["current_overshoot_pct_worst"] == pytest.approx(1.2)
    assert values["current_coils_beyond_supply"] == 1
    assert coil.row_of(found[2])[3:5] == ["never", "never"]
    with pytest.raises(BenchFailure, match="no coil"):
        coil.figures_of(found[2:])


def test_cuts_are_read_from_what_the_test_prints() -> None:
    printed = "a:1:b:PASS\nflash_cuts 120\nflash_lost 3\n\nOK\n"
    assert flash.figures_of("test", printed) == {"flash_cuts": 120, "flash_lost": 3}
    with pytest.raises(BenchFailure, match="test did not tell"):
        flash.figures_of("test", "a:1:b:FAIL\n")


def test_lost_records_are_a_figure_but_another_failure_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    program = tmp_path / "host/tests/unit/hal/test_slots"
    program.parent.mkdir(parents=True)
    good = program.with_name("test_nvm_cuts")
    good.write_text("#!/bin/sh\necho flash_cuts 5\necho flash_lost 0\n")
    good.chmod(good.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(flash, "build_folder", lambda: tmp_path)
    for lost in (2, 0):
        program.write_text(f"#!/bin/sh\necho flash_cuts 9\necho flash_lost {lost}\nexit 1\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        if lost:
            assert flash.measure(QUICK).values["flash_lost"] == 2
        else:
            with pytest.raises(BenchFailure, match="test_slots ended with"):
                flash.measure(QUICK)
