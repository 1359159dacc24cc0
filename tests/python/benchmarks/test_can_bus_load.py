"""Bus load and response times: against published numbers, and against a simulated bus."""

import json
import random

import pytest
from quiesce.can import bus_load
from quiesce.can.bus_load import Analysis, Stream, frame_bits
from quiesce.can.database import CYCLIC, Message, load

BITRATE = 1_000_000


def message(priority: int, period_ms: int, length: int = 8) -> Message:
    return Message(f"m{priority}", priority, length, "", CYCLIC, period_ms, 0, 0, None)


def analysis_of(streams: list[tuple[int, int]]) -> Analysis:
    """Of streams given as (bits, period in bits), in the order of priority."""
    found = Analysis([message(i, 1) for i in range(len(streams))], BITRATE)
    found.streams = [
        Stream(one.message, bits, period)
        for one, (bits, period) in zip(found.streams, streams, strict=True)
    ]
    return found


@pytest.mark.parametrize(
    ("length", "bits"), [(0, 55), (1, 65), (2, 75), (4, 95), (5, 105), (8, 135)]
)
def test_longest_frames(length: int, bits: int) -> None:
    assert frame_bits(length) == bits


def test_the_example_that_refuted_the_older_analysis() -> None:
    """Davis et al. 2007, table 1: frames of 1 ms each at periods of 2.5, 3.5 and 3.5 ms. The third
    message's second instance is the later one: 3.5 ms, where the older analysis gave 3.0."""
    found = analysis_of([(1000, 2500), (1000, 3500), (1000, 3500)])
    assert [found.response(i) for i in range(3)] == [2000, 3000, 3500]


def simulated(streams: list[tuple[int, int]], index: int, end: int) -> int:
    """Longest response of a message on a simulated bus: the longest frame below it has just begun
    when it and everything above it are queued for the first time."""
    below = [bits for bits, _ in streams[index + 1 :]]
    # The frame below begins one bit before the others, which is what blocks them for bits - 1.
    now = max(below) - 1 if below else 0
    queued = [0] * (index + 1)  # arrival of the oldest frame that waits
    worst = 0
    while now < end:
        ready = [i for i in range(index + 1) if queued[i] <= now]
        if not ready:
            now = min(queued)
            continue
        chosen = ready[0]
        bits, period = streams[chosen]
        now += bits
        if chosen == index:
            worst = max(worst, now - queued[chosen])
        queued[chosen] += period
    return worst


def test_no_simulated_bus_is_slower() -> None:
    rng = random.Random(7)
    tight = 0
    for _ in range(150):
        streams = [
            (frame_bits(rng.randint(0, 8)), rng.choice([500, 700, 1000, 1300, 2000, 5000]))
            for _ in range(rng.randint(1, 6))
        ]
        found = analysis_of(streams)
        for index in range(len(streams)):
            bound = found.response(index)
            if bound is None:
                continue
            measured = simulated(streams, index, 60_000)
            assert measured <= bound, (streams, index)
            tight += bound - measured <= 1 + 2 * index
    assert tight > 200  # the bound is no exaggeration


def test_a_bus_that_is_too_full_has_no_bound() -> None:
    found = analysis_of([(135, 200), (135, 200)])
    assert found.response(0) == 270
    assert found.response(1) is None


def test_errors_and_jitter_cost() -> None:
    messages = [message(1, 10), message(2, 10)]
    plain = Analysis(messages, 500_000).response(0)
    with_errors = Analysis(messages, 500_000, errors_per_s=10.0).response(0)
    with_jitter = Analysis(messages, 500_000, jitter_ms=0.1).response(0)
    assert plain == 270
    assert with_errors == 270 + 31 + 135
    assert with_jitter == 270 + 50


def test_the_interface_meets_its_goals() -> None:
    database = load()
    cyclic = bus_load.cyclic(database)
    raw = bus_load.named(database, bus_load.RAW)
    assert bus_load.load_pct(cyclic, 500_000) <= 34.0
    assert bus_load.load_pct(cyclic + raw, 500_000) <= 62.0
    response_ms = Analysis(bus_load.on_bus(database), 500_000).response_ms("CurrentDemand")
    assert response_ms is not None and response_ms <= 0.55


@pytest.mark.parametrize(
    ("sensors", "dampers", "with_sensors_pct"),
    [(0, 1, 33.7), (1, 1, 54.7), (1, 2, 75.6), (2, 2, 96.6), (0, 4, 96.4)],
)
def test_each_sensor_and_damper_costs(sensors: int, dampers: int, with_sensors_pct: float) -> None:
    """105 bits a sensor every 1 ms; 95 bits a damper every 1 ms and every 10 ms."""
    totals = bus_load.totals_pct(load(), 500_000, sensors, dampers)
    assert totals["with_sensor_node"] == pytest.approx(with_sensors_pct, abs=0.05)
    assert len(bus_load.on_bus(load(), sensors, dampers)) == 19 + sensors + 2 * dampers


def test_slcan_rate_covers_what_a_controller_sends() -> None:
    need, baud = bus_load.baud_needed([message(1, 1, 8)])
    assert (need, baud) == (220_000.0, 230_400)
    assert bus_load.baud_needed([message(1, 1, 8)] * 100)[1] is None


@pytest.mark.slow
def test_bus_load_prints_what_it_computes(quiesce) -> None:
    result = quiesce("can", "bus-load", "--json")
    assert result.returncode == 0
    report = json.loads(result.stdout)
    assert report["messages"][0]["name"] == "CurrentDemand"
    assert report["messages"][0]["response_ms"] == pytest.approx(0.46)
    totals = {name: round(value, 1) for name, value in report["load_pct"].items()}
    assert totals == {
        "cyclic": 33.7,
        "with_raw": 60.7,
        "with_sensor_node": 54.7,
        "with_sensor_node_and_raw": 81.7,
        "everything": 89.8,
        "with_table": 103.3,
    }
    for command in (("can", "bus-load"), ("bench", "can", "--no-vm")):
        out = quiesce(*command).stdout
        for total in totals.values():
            assert f"  {total}\n" in out
        assert "The first leaves out AccelSample" in out
    table = quiesce("can", "bus-load", "--bitrate", "125000", "--sensor-node")
    assert table.returncode == 0 and "no bound" in table.stdout


@pytest.mark.slow
def test_the_bench_says_what_it_could_not_judge(quiesce) -> None:
    result = quiesce("bench", "can", "--no-vm", "--check", "--json")
    assert result.returncode == 3, result.stderr
    report = json.loads(result.stdout)
    figures = {one["name"]: one for one in report["figures"]}
    computed = ("bus_load_pct", "bus_load_raw_pct", "demand_response_ms")
    assert all(figures[name]["ok"] for name in computed)
    assert figures["slcan_baud_needed"]["value"] == 921_600
    assert report["context"]["load_pct"]["with_sensor_node_and_raw"] == pytest.approx(
        81.7, abs=0.05
    )
    assert figures["estop_ticks"]["value"] is None and report["context"]["absent"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--bitrate", "0"], "--bitrate"),
        (["--bitrate", "2000000"], "1000000"),
        (["--jitter-ms", "-1"], "--jitter-ms"),
        (["--errors-per-s", "nan"], "--errors-per-s"),
        (["--sensors", "9"], "0 .. 8"),
        (["--dampers", "0"], "1 .. 4"),
        (["--dbc", "no.dbc"], "no.dbc"),
    ],
)
def test_bus_load_refuses(refused, options: list[str], words: str) -> None:
    assert words in refused("can", "bus-load", *options)


@pytest.mark.slow
def test_a_file_that_is_no_dbc_is_refused(refused, tmp_path) -> None:
    for name, content in (("a.dbc", b"nonsense {"), ("b.dbc", b"\xff\xfe"), ("c.dbc", b"")):
        (tmp_path / name).write_bytes(content)
        assert "not a DBC file" in refused("can", "bus-load", "--dbc", name)
