"""What ./tools/test runs for a change: tests of what was touched, and no more."""

import subprocess
import sys

import pytest
from conftest import ROOT


def touched(question: str, *lines: str) -> list[str]:
    call = [sys.executable, "-I", str(ROOT / "tools/lib/touched.py"), question]
    text = "\n".join(lines)
    result = subprocess.run(call, input=text, capture_output=True, text=True, check=True)
    return result.stdout.splitlines()


def test_a_block_of_the_firmware_brings_the_tests_that_see_it() -> None:
    lines = touched("edit", "firmware/sense/rms.c")
    assert lines[:2] == ["format firmware/sense/rms.c", "unit golden golden_streams ."]
    kind, folder, targets, regex = lines[2].split(" ")
    assert (kind, folder) == ("unit", "unit/firmware")
    names = targets.split(",")
    assert {"test_rms", "test_motion", "test_controller"} <= set(names)
    assert not {"test_crc32", "test_fuzzy"} & set(names)
    assert regex == f"^({'|'.join(names)})$"
    assert len(lines) == 3


@pytest.mark.parametrize(
    ("file", "expected"),
    [
        ("firmware/comm/slcan.c", "unit unit/comm tests/unit/comm/all ."),
        ("hal/linux/watchdog.c", "unit unit/linux tests/unit/linux/all ."),
        ("hal/records/nvm_records.c", "unit unit/hal tests/unit/hal/all ."),
        ("hal/parts/adxl355.c", "unit unit/linux tests/unit/linux/all ."),
        ("hal/parts/adxl355.c", "unit unit/stm32f4 tests/unit/stm32f4/all ."),
        ("hal/image/sha256.c", "unit unit/hal tests/unit/hal/all ."),
        ("hal/cortex_m/fault_record.c", "unit unit/stm32f4 tests/unit/stm32f4/all ."),
        ("targets/stm32f4/output.c", "unit unit/stm32f4 tests/unit/stm32f4/all ."),
        ("targets/stm32f4/boards/olimex_h405.c", "pytest tests/python/docs/test_stm32f4_page.py"),
        ("tests/unit/plant/test_plant.cpp", "unit unit/plant tests/unit/plant/all ."),
        ("sim_hil/board/board_file.cpp", "unit unit/board tests/unit/board/all ."),
        ("sim_hil/plant/actuator.cpp", "unit unit/plant tests/unit/plant/all ."),
        ("sim_hil/python/plant_handle.cpp", "unit unit/plant tests/unit/plant/all ."),
        ("tests/golden/streams.c", "unit golden golden_streams ."),
        ("hal/mps2/startup.c", "board"),
        ("tools/src/quiesce/rules/words.py", "ruff tools/src/quiesce/rules/words.py"),
        ("tools/src/quiesce/rules/words.py", "pytest tests/python/rules"),
        ("tools/src/quiesce/cli/words.py", "pytest tests/python/gates/test_bad_input.py"),
        ("tests/python/can/test_can_e2e.py", "pytest tests/python/can/test_can_e2e.py"),
        ("tools/benchmarks/quiesce_benchmarks/report.py", "pytest tests/python/benchmarks"),
        ("examples/first_loop/first_loop.c", "pytest tests/python/docs"),
        ("tools/test", "script tools/test"),
        ("tools/test", "pytest tests/python/gates/test_setup_scripts.py"),
        ("tools/hil", "pytest tests/python/gates/test_start_without_build.py"),
        ("firmware/param/parameters.toml", "generated"),
    ],
)
def test_a_file_brings(file: str, expected: str) -> None:
    assert expected in touched("edit", file)


def test_pages_bring_the_tests_of_pages() -> None:
    tests = [f"pytest tests/python/docs/test_{name}.py" for name in ("pages", "results")]
    assert touched("edit", "docs/index.md", "README.md") == tests


def test_a_test_of_the_firmware_brings_itself() -> None:
    file = "tests/unit/firmware/test_rms.c"
    assert touched("edit", file)[1:] == ["unit unit/firmware test_rms ^(test_rms)$"]


def test_tidy_takes_what_changed_most_and_a_source_for_a_header() -> None:
    lines = ["3 firmware/sense/rms.c", "9 firmware/base/trig.h", "50 docs/index.md"]
    assert touched("tidy", *lines) == ["firmware/base/trig.c", "firmware/sense/rms.c"]
    many = [f"{n} firmware/sense/f{n}.c" for n in range(100)]
    chosen = touched("tidy", *many)
    assert len(chosen) == 24
    assert chosen[0] == "firmware/sense/f99.c"


@pytest.mark.parametrize(
    ("lines", "area"),
    [
        ([], "firmware"),
        (["5 firmware/sense/rms.c", "9 hal/linux/watchdog.c"], "linux"),
        (["5 firmware/sense/rms.c", "90 sim_hil/plant/actuator.cpp"], "firmware"),
        (["5 firmware/comm/slcan.c", "9 hal/parts/iis3dwb.c"], "linux"),
        (["5 firmware/comm/slcan.c", "90 docs/index.md"], "comm"),
    ],
)
def test_sanitizers_take_the_area_that_changed_most(lines: list[str], area: str) -> None:
    assert touched("area", *lines) == [area]
