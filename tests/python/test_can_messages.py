"""quiesce.dbc against the C header that it describes."""

import re
from pathlib import Path

import cantools
import pytest

ROOT = Path(__file__).resolve().parents[2]
DATABASE = cantools.database.load_file(ROOT / "firmware/comm/quiesce.dbc")
QUIESCE_H = (ROOT / "firmware/include/quiesce.h").read_text()
WORD = re.compile(r"^\s+(u?int32_t|quiesce_peak_t) (\w+)(?:\[QUIESCE_PEAKS\])?;", re.MULTILINE)


def struct_words(name: str) -> list[tuple[str, bool]]:
    """Fields of a C struct that ends with `} name;`: name and signedness."""
    body = QUIESCE_H.split(f"}} {name};")[0].rsplit("typedef struct {", 1)[1]
    words = []
    for kind, field in WORD.findall(body):
        if kind == "quiesce_peak_t":
            words += [
                (f"peak{i}_{part}", True)
                for i in range(3)
                for part in ("freq_uHz", "amp_um_s2", "phase_mdeg")
            ]
        else:
            words.append((field, kind == "int32_t"))
    return words


def enum_values(prefix: str) -> dict[int, str]:
    rows = re.findall(rf"^\s+{prefix}_(\w+) = (\d+),", QUIESCE_H, re.MULTILINE)
    return {int(number): label for label, number in rows}


def test_telemetry_messages_are_the_words_of_the_telemetry_struct():
    messages = [m for m in DATABASE.messages if m.name.startswith("Telemetry")]
    first = messages[0].frame_id
    assert [m.frame_id for m in messages] == list(range(first, first + len(messages)))
    signals = [m.signals[0] for m in messages]
    assert [(s.name, s.is_signed) for s in signals] == struct_words("quiesce_telemetry_t")
    assert all(s.start == 0 and s.length == 32 for s in signals)


@pytest.mark.parametrize(
    ("signal", "prefix"), [("state", "QUIESCE_STATE"), ("fault", "QUIESCE_FAULT")]
)
@pytest.mark.parametrize("message", ["LockstepCommand", "telemetry"])
def test_value_tables_are_the_enumerations(message, signal, prefix):
    name = f"Telemetry{signal.capitalize()}" if message == "telemetry" else message
    choices = DATABASE.get_message_by_name(name).get_signal_by_name(signal).choices
    assert {number: str(label) for number, label in choices.items()} == enum_values(prefix)


def test_every_message_and_signal_is_described():
    for message in DATABASE.messages:
        assert message.comment and message.frame_id <= 0x7FF, message.name
        for signal in message.signals:
            assert signal.comment and signal.byte_order == "little_endian", signal.name


def test_units_match_the_names():
    for message in DATABASE.messages:
        for signal in message.signals:
            suffix = re.search(r"_(uHz|um_s2|um_s|mA|mdeg|nm|ms|us|ticks|counts)$", signal.name)
            unit = {"um_s2": "um/s2", "um_s": "um/s", "ticks": "tick", "counts": "count"}
            expected = suffix and unit.get(suffix[1], suffix[1])
            assert signal.unit == expected, signal.name


def test_frames_of_a_tick_carry_at_most_four_bytes():
    for message in DATABASE.messages:
        if message.name.startswith("Telemetry") or message.name in (
            "LockstepStimulus",
            "LockstepCurrent",
            "LockstepCommand",
        ):
            assert message.length == 4, message.name
