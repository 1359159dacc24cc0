"""The page of the STM32F4 says what the files of the boards say."""

import re

import pytest
from conftest import ROOT

BOARDS = ROOT / "targets/stm32f4/boards"
PAGE = (ROOT / "docs/howto/stm32f4.md").read_text()
PIN = re.compile(r"\.(\w+) = \{?PIN_([ABC])\((\d+)\)")
ROW = re.compile(r"^\| `(\w+)` \| (P[ABC]\d+) \| [^|]* \| (P[ABC]\d+) \|", re.MULTILINE)
FIGURE_PIN = re.compile(r">(P[ABC]\d+) (\w+(?:-\d+)?)<")


def pins_of(board: str) -> dict[str, str]:
    text = (BOARDS / f"{board}.c").read_text()
    if "USUAL_WIRING" in text:
        text += (BOARDS / "usual_wiring.h").read_text()
    return {name: f"P{port}{number}" for name, port, number in PIN.findall(text)}


def rows(column: int) -> dict[str, str]:
    return {row[0]: row[column] for row in ROW.findall(PAGE)}


@pytest.mark.parametrize(("board", "column"), [("nucleo_f446re", 1), ("olimex_h405", 2)])
def test_the_table_of_pins_is_the_boards(board: str, column: int) -> None:
    pins = pins_of(board)
    assert len(pins) >= 16
    assert rows(column) == pins


@pytest.mark.parametrize("board", [file.stem for file in BOARDS.glob("*.c")])
def test_no_pin_of_a_board_is_used_twice(board: str) -> None:
    pins = list(pins_of(board).values())
    assert sorted(pins) == sorted(set(pins))
    # The debugger's, and the DAC's, which has no choice.
    assert not {"PA13", "PA14", "PB3", "PA4"} & set(pins)


def test_the_figure_has_the_pins_of_the_board() -> None:
    figure = (ROOT / "docs/howto/figures/stm32f4-nucleo.svg").read_text()
    shown = {pin for pin, _ in FIGURE_PIN.findall(figure)}
    beside = {"PA2", "PA3", "PC13", "PB8", "PB9"}  # console, button, CAN
    assert shown == set(pins_of("nucleo_f446re").values()) - beside


def test_every_board_has_its_line_and_its_name() -> None:
    lines = (BOARDS.parent / "boards.cmake").read_text()
    named = re.findall(r"^quiesce_stm32f4_board\((\w+)\)$", lines, re.MULTILINE)
    assert sorted(named) == sorted(file.stem for file in BOARDS.glob("*.c"))
    for board in named:
        assert f'.name = "{board}"' in (BOARDS / f"{board}.c").read_text()
