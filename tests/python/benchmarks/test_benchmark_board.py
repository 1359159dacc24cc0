"""`./tools/benchmark board`: its parts find what they are to find."""

import stat
from pathlib import Path

import pytest
from quiesce.base.errors import BenchFailure, UsageError
from quiesce_benchmarks.board.disassembly import read_graph
from quiesce_benchmarks.board.parts import bits, resources
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
