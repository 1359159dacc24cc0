"""Text tables: where the columns are, how cells are written, what a terminal gets."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from quiesce.base.table import format_pairs, format_table

SRC = Path(__file__).resolve().parents[3] / "tools/src"
PROGRAM = (
    "from quiesce.base.table import format_table; from quiesce.cli.terminal import show;"
    "show(format_table(['law', 'x'], [['[red]off', '1' * 200]]) + '\\n\\nend')"
)
PLAIN = f"law       {' ' * 199}x\n--------  {'-' * 200}\n[red]off  {'1' * 200}\n\nend\n"


def on_terminal(**environment: str) -> str:
    """What the program prints on a terminal of 80 columns."""
    master, slave = pty.openpty()
    given = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "TERM")}
    call = [sys.executable, "-c", PROGRAM]
    given |= {"PYTHONPATH": str(SRC), "COLUMNS": "80", **environment}
    with subprocess.Popen(call, stdout=slave, env=given) as program:
        os.close(slave)
        text = b""
        while True:
            try:
                block = os.read(master, 4096)
            except OSError:  # its last writer has gone
                break
            if not block:
                break
            text += block
    os.close(master)
    assert program.returncode == 0
    return text.decode().replace("\r\n", "\n")


def test_columns_cells_and_groups() -> None:
    head = ["law", "x %\nours||z.1f", "current||g A"]
    rows = ["a group whose heading is longer than the table", ["off", -0.01, None]]
    assert format_table(head, [*rows, ["on", 12.0, 0.5]]).splitlines() == [
        "      x %",
        "law  ours  current",
        "---  ----  -------",
        "a group whose heading is longer than the table",
        "off   0.0        -",
        "on   12.0    0.5 A",
    ]
    assert format_table(["a", "b"], [["x", "y"]], left=(0, 1), gap=1) == "a b\n- -\nx y"
    assert format_table(["a", "bc"], []) == "a  bc\n-  --"


def test_a_row_of_another_length_is_an_error() -> None:
    with pytest.raises(ValueError):
        format_table(["a", "b"], [["x"]])


def test_pairs() -> None:
    assert format_pairs({"file": "a", "size of": 3}) == "file     a\nsize of  3"


def test_a_file_gets_plain_text() -> None:
    environment = {**os.environ, "PYTHONPATH": str(SRC), "TERM": "xterm-256color"}
    call = [sys.executable, "-c", PROGRAM]
    assert subprocess.check_output(call, env=environment, text=True) == PLAIN


def test_a_terminal_gets_the_same_text_with_a_bold_head() -> None:
    shown = on_terminal(TERM="xterm-256color")
    head, rule, *rest = PLAIN.split("\n")
    assert shown.split("\n") == [f"\x1b[1m{head}\x1b[0m", f"\x1b[2m{rule}\x1b[0m", *rest]


@pytest.mark.parametrize("environment", [{"NO_COLOR": "1", "TERM": "xterm"}, {"TERM": "dumb"}])
def test_a_terminal_without_styles_gets_plain_text(environment: dict[str, str]) -> None:
    assert on_terminal(**environment) == PLAIN
