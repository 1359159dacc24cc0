"""What a guest prints, QEMU's control protocols, figures made of them; without a machine."""

import json
import socket
import threading

import pytest
from quiesce.base.errors import BenchFailure
from quiesce_vm import measure, qmp
from quiesce_vm.boots import ECHOES, BusRun, Estop, TimingRun
from quiesce_vm.results import ending_of, result_of, results_of


def test_results_by_name_amid_other_lines() -> None:
    lines = ["[    0.5] booting", 'RESULT {"name": "a", "v": 1}', "noise", "TEST-RC 0"]
    assert results_of(lines) == {"a": {"name": "a", "v": 1}}


@pytest.mark.parametrize(
    "line",
    [
        "RESULT ",
        "RESULT {",
        'RESULT {"name": "a", ',
        "RESULT [1]",
        "RESULT 1",
        'RESULT {"v": 1}',
        'RESULT {"name": 7}',
        "RESULT \ufffd\ufffd",
    ],
)
def test_broken_result_is_refused(line: str) -> None:
    with pytest.raises(BenchFailure, match="a result that is none") as failure:
        result_of(line)
    assert "\n" not in str(failure.value)


def test_result_that_comes_twice_is_refused() -> None:
    line = 'RESULT {"name": "a"}'
    with pytest.raises(BenchFailure, match="twice"):
        results_of([line, line, "TEST-RC 0"])


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        (["TEST-RC 0"], 0),
        (["TEST-RC 139", "more"], 139),
        ([], None),
        (["TEST-RC "], None),
        (["TEST-RC -1"], None),
        (["TEST-RC zero"], None),
        (["TEST-RC 0", "TEST-RC 0"], None),
        (["echo TEST-RC 0"], None),
    ],
)
def test_ending_of_the_script(lines: list[str], code: int | None) -> None:
    assert ending_of(lines) == code


@pytest.mark.parametrize(
    ("lines", "words"),
    [(["RESULTS"], "did not end"), (["TEST-RC 1"], "ended with 1")],
)
def test_script_that_failed_is_told(lines: list[str], words: str) -> None:
    with pytest.raises(BenchFailure, match=words):
        results_of(lines)


# QMP and qtest: the far end is a socket that says what QEMU would, or worse


def serve(replies: list[str]) -> socket.socket:
    """The near end; the far one says the first line at once, and one more for each it gets."""
    near, far = socket.socketpair()

    def talk() -> None:
        with far, far.makefile("rw") as lines:
            for reply in replies:
                lines.write(reply + "\n")
                lines.flush()
                if not lines.readline():
                    return

    threading.Thread(target=talk, daemon=True).start()
    return near


GREETING = '{"QMP": {}}'
EVENT = '{"event": "RESUME"}'


def test_qmp_finds_a_device_whatever_its_number() -> None:
    devices = [
        {"name": "device[3]", "type": "child<pl011>"},
        {"name": "device[7]", "type": "child<pl061>"},
    ]
    with serve([GREETING, '{"return": {}}', json.dumps({"return": devices})]) as near:
        assert qmp.Qmp(near).device("pl061") == "/machine/unattached/device[7]"


def test_qmp_without_the_device_is_told() -> None:
    with serve([GREETING, '{"return": {}}', '{"return": []}']) as near:
        with pytest.raises(BenchFailure, match="no pl061"):
            qmp.Qmp(near).device("pl061")


def test_qmp_refusal_is_told() -> None:
    refusal = '{"error": {"class": "CommandNotFound", "desc": "never heard of it"}}'
    with serve([GREETING, EVENT + '\n{"return": {}}', refusal]) as near:
        with pytest.raises(BenchFailure, match="refused query-nothing: never heard of it"):
            qmp.Qmp(near).execute("query-nothing")


@pytest.mark.parametrize("reply", ["", "{", "[]", "QEMU 7.2", '"text"'])
def test_qmp_answer_that_is_none_is_told(reply: str) -> None:
    with serve([GREETING, reply]) as near:
        with pytest.raises(BenchFailure, match="which is no answer"):
            qmp.Qmp(near)


def test_qmp_tells_how_the_machine_stopped() -> None:
    event = '{"event": "SHUTDOWN", "data": {"guest": true, "reason": "guest-reset"}}'
    with serve([GREETING, f'{{"return": {{}}}}\n{EVENT}\n{event}']) as near:
        assert qmp.Qmp(near).ending() == "guest-reset"


@pytest.mark.parametrize(
    ("text", "change"),
    [
        ("IRQ raise 2", (2, True)),
        ("IRQ lower 12\n", (12, False)),
        ("OK", None),
        ("OK IRQ raise 2", None),
        ("IRQ raise", None),
        ("IRQ raise -1", None),
        ("IRQ toggle 1", None),
        ("", None),
    ],
)
def test_qtest_line(text: str, change: tuple[int, bool] | None) -> None:
    assert qmp.output_change(text) == change


# Figures


def link(rx: int, tx: int, dropped: int = 0) -> dict:
    counts = {"errors": 0, "dropped": dropped}
    return {
        "link": [{"stats64": {"rx": {"packets": rx, **counts}, "tx": {"packets": tx, **counts}}}]
    }


def bus_run(after: dict, echo_wrong: int = 0) -> BusRun:
    results = {"before_echo": link(5, 7), "after_echo": after}
    return BusRun(results, {}, echo_wrong, {}, Estop({}, {}, ""), [], {}, [], 0)


@pytest.mark.parametrize(
    ("run", "lost"),
    [
        (bus_run(link(ECHOES + 5, ECHOES + 7)), 0),
        (bus_run(link(ECHOES + 6, ECHOES + 9)), 0),  # others' frames
        (bus_run(link(ECHOES + 2, ECHOES + 7)), 3),
        (bus_run(link(ECHOES + 5, ECHOES + 7, dropped=2)), 4),
        (bus_run(link(ECHOES + 5, ECHOES + 7), echo_wrong=9), 9),
    ],
)
def test_frames_lost(run: BusRun, lost: int) -> None:
    assert measure.frames_lost(run) == lost


def timing_run(
    *delays_ns: int, summary: str = "T: 0 P:80 Min: 9 Avg: 10 Max:      40"
) -> TimingRun:
    results = {
        f"press{i}": {"pressed_ns": 1000, "safe_ns": 1000 + delay_ns}
        for i, delay_ns in enumerate(delays_ns)
    }
    results["status"] = {"status": {"loop": {"lateness": {"worst_us": 50.0}}}}
    results["cyclictest"] = {"summary": summary}
    return TimingRun(results, [], "")


@pytest.mark.parametrize(
    ("delays_ns", "ticks"), [((1,), 1), ((1_000_000,), 1), ((400, 1_000_001), 2)]
)
def test_estop_ticks_count_begun_ones(delays_ns: tuple[int, ...], ticks: int) -> None:
    assert measure.estop_ticks(timing_run(*delays_ns)) == ticks


def test_without_a_press_there_is_no_figure() -> None:
    with pytest.raises(BenchFailure, match="never pressed"):
        measure.estop_ticks(timing_run())


def test_lateness_over_cyclictest() -> None:
    assert measure.lateness_over_cyclictest(timing_run().results) == 1.25


def test_cyclictest_without_a_summary_is_told() -> None:
    with pytest.raises(BenchFailure, match="cyclictest said"):
        measure.cyclictest_worst_us(timing_run(summary="no such file").results)
