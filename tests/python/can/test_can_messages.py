"""quiesce.dbc against the C that it describes, the frames that the firmware makes, the manual."""

import importlib.util
import re
import subprocess

import pytest
import quiesce
from can_protection import crc8_j1850, frame_crc, is_protected, load_database
from conftest import ROOT, require

DATABASE = load_database()
QUIESCE_H = "".join(
    (ROOT / f"firmware/include/{name}.h").read_text() for name in ("quiesce", "quiesce_faults")
)
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


def test_telemetry_messages_are_the_words_of_the_telemetry_struct_and_the_report():
    messages = [m for m in DATABASE.messages if m.name.startswith("Telemetry")]
    first = messages[0].frame_id
    assert [m.frame_id for m in messages] == list(range(first, first + len(messages)))
    signals = [m.signals[0] for m in messages]
    report = [(f"report{i}", True) for i in range(8)]
    words = struct_words("quiesce_telemetry_t") + report
    assert [(s.name, s.is_signed) for s in signals] == words
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
            suffix = re.search(
                r"_(uHz|um_s2|um_s|kHz|mA|mdeg|nm|ms|us|ticks|counts|cycles)$", signal.name
            )
            unit = {"um_s2": "um/s2", "um_s": "um/s"}
            unit |= {"ticks": "tick", "counts": "count", "cycles": "cycle"}
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


def controller_messages():
    return [m for m in DATABASE.messages if "Controller" in m.senders]


def bus_messages():
    return [m for m in DATABASE.messages if not {"Bench", "Target"} & {*m.senders, *m.receivers}]


def attribute(message, name):
    found = message.dbc.attributes.get(name)
    return found.value if found else 0


@pytest.fixture(scope="module")
def sent_frames(build) -> list[tuple[int, bytes]]:
    """What a controller sends with every word at an end of its range, then at random."""
    program = require(build / "host/tests/unit/comm/can_frames")
    lines = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
    assert all(line[0] == "t" and len(line) == 5 + 2 * int(line[4], 16) for line in lines)
    return [(int(line[1:4], 16), bytes.fromhex(line[5:])) for line in lines]


def test_every_frame_of_the_controller_decodes_with_values_in_range(sent_frames):
    seen = set()
    for frame_id, data in sent_frames:
        message = DATABASE.get_message_by_frame_id(frame_id)
        assert "Controller" in message.senders and len(data) == message.length
        for name, value in message.decode(data, decode_choices=False).items():
            signal = message.get_signal_by_name(name)
            assert signal.minimum <= value <= signal.maximum, (message.name, name, value)
        seen.add(message.name)
    assert seen == {m.name for m in controller_messages()}


def test_every_protected_frame_has_the_crc_of_the_description(sent_frames):
    checked = set()
    for frame_id, data in sent_frames:
        message = DATABASE.get_message_by_frame_id(frame_id)
        if is_protected(message):
            assert data[-1] == frame_crc(frame_id, data), message.name
            checked.add(message.name)
    demands = {"CurrentDemand", "CurrentDemand1", "CurrentDemand2", "CurrentDemand3"}
    assert checked == demands | {"Status", "ServiceReply"}


def test_alive_counters_of_the_controller_go_up_by_one(sent_frames):
    last = {}
    for frame_id, data in sent_frames:
        message = DATABASE.get_message_by_frame_id(frame_id)
        if is_protected(message) and message.name != "ServiceReply":
            alive = message.decode(data, decode_choices=False)["alive"]
            assert alive == (last.get(frame_id, -1) + 1) % 16
            last[frame_id] = alive


def test_crc_has_its_published_check_value():
    assert crc8_j1850(b"123456789") == 0x4B


def test_example_in_the_documentation_is_right():
    text = (ROOT / "docs/reference/can-messages.md").read_text()
    rows = re.findall(r"^(\w+) 0x([0-9A-F]{3}): `([0-9A-F ]+)`", text, re.MULTILINE)
    assert rows
    for name, frame_id, data in rows:
        data = bytes.fromhex(data)
        assert DATABASE.get_message_by_name(name).frame_id == int(frame_id, 16)
        assert data[-1] == frame_crc(int(frame_id, 16), data)


def test_table_in_the_documentation_is_the_dbc():
    text = (ROOT / "docs/reference/can-messages.md").read_text()
    rows = re.findall(
        r"^\| 0x(\w{3}) \| (\w+) \| (\d) \| (\w+) \| (.+?) \| (.+?) \| (.*?) \|", text, re.M
    )
    expected = []
    for m in sorted(bus_messages(), key=lambda m: m.frame_id):
        cycle_ms, timeout_ms = m.cycle_time, attribute(m, "QuiesceTimeoutMs")
        expected.append(
            (
                f"{m.frame_id:03X}",
                m.name,
                str(m.length),
                m.senders[0],
                f"{cycle_ms} ms" if cycle_ms else "on request",
                f"{timeout_ms} ms" if timeout_ms else "-",
                "yes" if is_protected(m) else "",
            )
        )
    assert rows == expected


def test_services_and_their_results_are_the_firmwares():
    header = (ROOT / "firmware/comm/can_service.h").read_text()
    body = header.split("} can_node_result_t;")[0].rsplit("typedef enum {", 1)[1]
    rows = {int(n): label for label, n in re.findall(r"CAN_NODE_(\w+) = (\d+),", body)}
    choices = DATABASE.get_message_by_name("ServiceReply").get_signal_by_name("result").choices
    assert {number: str(label) for number, label in choices.items()} == rows


def test_each_sensor_and_damper_has_its_messages():
    """Number k under the id of number 0 + k, and everything but the names the same."""
    families = {
        "CurrentDemand": ("CurrentDemand", 4),
        "AccelSample": ("SensorSample", 8),
        "CurrentMeasured": ("CurrentMeasured", 4),
    }
    for name, (others, count) in families.items():
        first = DATABASE.get_message_by_name(name)
        for k in range(1, count):
            other = DATABASE.get_message_by_name(f"{others}{k}")
            assert other.frame_id == first.frame_id + k
            assert (other.senders, other.receivers) == (first.senders, first.receivers)
            for mine, its in zip(other.signals, first.signals, strict=True):
                assert mine.receivers == its.receivers and mine.choices == its.choices
                assert (mine.minimum, mine.maximum, mine.unit) == (
                    its.minimum,
                    its.maximum,
                    its.unit,
                )


def test_stop_goes_before_every_sample_and_demands_before_all():
    ids = {m.name: m.frame_id for m in DATABASE.messages}
    assert ids["CurrentDemand3"] < ids["EmergencyStop"] < ids["AccelSample"]
    assert ids["SensorSample7"] < ids["CurrentMeasured"]
    assert ids["CurrentMeasured3"] < ids["OperatorCommand"] < ids["Status"]


@pytest.mark.parametrize(
    ("message", "signal", "prefix"),
    [
        ("CurrentDemand", "state", "QUIESCE_STATE"),
        ("Status", "state", "QUIESCE_STATE"),
        ("Status", "fault", "QUIESCE_FAULT"),
        ("FaultFreeze", "freeze_state", "QUIESCE_STATE"),
        ("FaultFreeze", "freeze_fault", "QUIESCE_FAULT"),
    ],
)
def test_value_tables_of_the_bus_are_the_enumerations(message, signal, prefix):
    choices = DATABASE.get_message_by_name(message).get_signal_by_name(signal).choices
    assert {number: str(label) for number, label in choices.items()} == enum_values(prefix)


def test_cyclic_messages_never_meet():
    """At 500 Hz a tick takes two slots of 1 ms: phases differ in those, too."""
    slots = {}
    for message in controller_messages():
        start_ms = attribute(message, "GenMsgStartDelayTime")
        if (
            message.cycle_time
            and message.cycle_time > 1
            and message.name
            not in (
                "FaultFreeze",
                "FaultRecord",
            )
        ):
            assert start_ms < message.cycle_time and start_ms % 2 == 0
            for ms in range(start_ms, 1000, message.cycle_time):
                assert ms not in slots, (message.name, slots[ms])
                slots[ms] = message.name


def test_version_is_one():
    header = (ROOT / "firmware/include/quiesce_version.h").read_text()
    numbers = re.findall(r"QUIESCE_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header)
    assert ".".join(numbers) == quiesce.__version__


def load_generator():
    spec = importlib.util.spec_from_file_location("dbc_generator", ROOT / "tools/gen/dbc.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


MISTAKES = {
    "crc must be the last byte": (
        ' SG_ crc : 24|8@1+ (1,0) [0|255] "" Driver,Host\n\nBO_ 32',
        ' SG_ crc : 24|7@1+ (1,0) [0|127] "" Driver,Host\n\nBO_ 32',
    ),
    "alive must be 4 bits within one byte": (
        'SG_ alive : 20|4@1+ (1,0) [0|15] "" Driver,Host',
        'SG_ alive : 21|3@1+ (1,0) [0|7] "" Driver,Host',
    ),
    "a protected message has both alive and crc": (
        ' SG_ alive : 4|4@1+ (1,0) [0|15] "" Controller\n',
        "",
    ),
    "scale 1 and offset 0 only": ('0|16@1+ (1,0) [0|65535] "mA"', '0|16@1+ (0.1,0) [0|65535] "mA"'),
    "little-endian (@1) only": ("freq_uHz : 0|32@1-", "freq_uHz : 7|32@0-"),
    "id 0x110 is SpectrumPeak0's": ("BO_ 273 SpectrumPeak1", "BO_ 272 SpectrumPeak1"),
    "overlapping": ("fault_reset : 1|1@1+", "fault_reset : 0|1@1+"),
    "GenMsgStartDelayTime must be below": (
        '"GenMsgStartDelayTime" BO_ 264 2;',
        '"GenMsgStartDelayTime" BO_ 264 20;',
    ),
    "SensorSample2: its id must be AccelSample's + 2": (
        "BO_ 50 SensorSample2",
        "BO_ 63 SensorSample2",
    ),
    "SensorSample1: layout and times must be AccelSample's": (
        "sample_counts : 0|24@1-",
        "sample_counts : 0|16@1-",
    ),
    "CurrentDemand1: layout and times must be CurrentDemand's": (
        '"GenMsgCycleTime" BO_ 17 1;',
        '"GenMsgCycleTime" BO_ 17 2;',
    ),
    "classic frames of 11-bit ids only": ("BO_ 264 Motion", "BO_ 2147483912 Motion"),
}


@pytest.mark.parametrize("why", MISTAKES)
def test_generator_refuses_a_dbc_that_the_firmware_could_not_be_sure_of(why):
    old, new = MISTAKES[why]
    text = (ROOT / "firmware/comm/quiesce.dbc").read_text()
    changed = text.replace(old, new, 1)
    assert changed != text
    with pytest.raises(ValueError, match=re.escape(why)) as error:
        load_generator().generate_sources(changed.encode())
    assert len(str(error.value).splitlines()) == 1


def test_generator_is_deterministic():
    source = (ROOT / "firmware/comm/quiesce.dbc").read_bytes()
    assert load_generator().generate_sources(source) == load_generator().generate_sources(source)


def test_generated_narrowing_has_no_floating_point():
    for name in ("quiesce_can_tables.h", "quiesce_can_tables.c"):
        text = (ROOT / "firmware/comm/generated" / name).read_text()
        assert not re.search(r"\b(float|double)\b", text)
