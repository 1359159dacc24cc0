"""The table of faults: numbers for ever, and a test that exists for each."""

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import cantools
import pytest
from conftest import ROOT
from quiesce_benchmarks.trust.named_tests import exists, missing

# In logs, in stored records and in other people's programs: they never change.
FOR_EVER = (
    "NONE PARAMETER SENSOR_LOST SENSOR_SATURATED SENSOR_STUCK SENSOR_RANGE DRIVER_NOT_FOLLOWING "
    "COIL_OPEN CURRENT_LOST TICK_LOST ESTOP SENSOR_QUIET DRIVER_FAILED LAW_BLIND OVERCURRENT "
    "COIL_HOT MEMORY COIL_SHORT SENSOR_POLARITY"
).split()
ROW = """[[fault]]
name = "A"
number = 1
class = "latched"
brief = "b"
cause = "c"
reaction = "r"
time = "t"
recovery = "w"
tests = ["x.c::test_x"]
"""


def load_generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("faults", ROOT / "tools/gen/faults.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


faults = load_generator()


def rows() -> list[dict]:
    return faults.load((ROOT / faults.SOURCE).read_text())


def test_numbers_are_for_ever() -> None:
    table = (ROOT / faults.SOURCE).read_text()
    known = {one["number"]: one["name"] for one in rows()}
    retired = {int(n) for n in re.findall(r"\[\[retired\]\]\n(?:.*\n)??number = (\d+)", table)}
    for number, name in enumerate(FOR_EVER[1:], 1):
        assert number in retired or known[number] == name


def test_header_bus_and_table_agree() -> None:
    known = {0: "NONE"} | {one["number"]: one["name"] for one in rows()}
    header = (ROOT / faults.HEADER).read_text()
    found = re.findall(r"QUIESCE_FAULT_([A-Z_]+) = (\d+)", header)
    assert {int(number): name for name, number in found} == known
    bus = cantools.database.load_file(ROOT / faults.DBC)
    signals = [
        signal
        for message in bus.messages
        for signal in message.signals
        if signal.name in ("fault", "freeze_fault")
    ]
    assert len(signals) == 4
    for signal in signals:
        assert {int(n): str(name) for n, name in signal.choices.items()} == known


def test_every_fault_has_tests_that_exist() -> None:
    assert missing([test for one in rows() for test in one["tests"]], ROOT) == []


def test_a_test_that_is_not_there_is_missed() -> None:
    file = "tests/unit/firmware/test_guard.c"
    assert exists(f"{file}::test_guard_denies_by_default", ROOT)
    assert not exists(f"{file}::test_guard_denies", ROOT)
    assert not exists("tests/unit/firmware/test_nothing.c::test_guard_denies_by_default", ROOT)
    assert exists(
        "tests/unit/linux/quiesced/test_fault.cpp::FaultLatch.a_button_that_is_stuck"
        "_acknowledges_nothing",
        ROOT,
    )
    assert not exists(
        "tests/unit/linux/quiesced/test_fault.cpp::FaultStore.a_button_that_is_stuck"
        "_acknowledges_nothing",
        ROOT,
    )
    assert exists("tests/python/gates/test_faults.py::test_numbers_are_for_ever", ROOT)
    with pytest.raises(ValueError, match="expected FILE::NAME"):
        exists("test_guard", ROOT)


def test_a_test_that_is_not_run_does_not_count(tmp_path: Path) -> None:
    (tmp_path / "a.c").write_text("static void test_a(void) {\n}\n    // RUN_TEST(test_a);\n")
    assert not exists("a.c::test_a", tmp_path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (ROW + ROW, "name A stands twice"),
        (ROW + ROW.replace('"A"', '"B"'), "number 1 stands twice"),
        (ROW.replace("number = 1", "number = 2"), "number 1 is missing"),
        (ROW + '[[retired]]\nname = "B"\nnumber = 1\n', "number 1 stands twice"),
        (ROW + '[[retired]]\nname = "A"\nnumber = 2\n', "name A stands twice"),
        (ROW.replace("latched", "bad"), "a class is"),
        (ROW.replace('["x.c::test_x"]', "[]"), "one test is the least"),
        (ROW.replace('cause = "c"\n', ""), "the keys must be"),
        (ROW.replace("number = 1", "number = 256"), "a number is 1 .. 255"),
        (
            ROW.replace('"A"', '"B"').replace("number = 1", "number = 2") + ROW,
            "in the order of their numbers",
        ),
    ],
)
def test_what_a_table_may_not_say(text: str, words: str) -> None:
    assert len(faults.load(ROW)) == 1
    with pytest.raises(ValueError, match=re.escape(words)):
        faults.load(text)


def test_a_retired_number_leaves_a_gap() -> None:
    later = ROW.replace("number = 1", "number = 2")
    retired = '[[retired]]\nname = "OLD"\nnumber = 1\n'
    assert [one["number"] for one in faults.load(later + retired)] == [2]
