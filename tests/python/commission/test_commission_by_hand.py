"""A real controller on a bus: what arms it asks first, and whatever ends that leaves it safe."""

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from can_bus import Controller, build_peer
from conftest import ROOT
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.can.buses import Bus
from quiesce.can.database import load
from quiesce.can.emergency import StopFrames
from quiesce.can.link import Link
from quiesce.commission.by_hand import STOP_S, SiteByHand, to_play
from quiesce.commission.folder import Folder
from quiesce.commission.hand import Left
from quiesce.commission.run import Order, commission
from quiesce.commission.site import give
from quiesce.commission.steps import excite, wiring
from quiesce.commission.steps import load as load_step
from quiesce.commission.steps.wiring import limits
from quiesce.commission.wants import Wants
from quiesce.commission.work import Work
from quiesce.plant_id.sweep import SweepPlan, timeline
from quiesce.rig import Rig

LIMIT_mA = 800
DEMAND = "current_demand/current_cmd_mA"


class Somebody:
    """Does all that is asked, and keeps it."""

    def __init__(self, allows: bool = True) -> None:
        self.asked: list[str] = []
        self.allows = allows

    def do(self, text: str) -> None:
        self.asked.append(text)

    def allow(self, text: str) -> None:
        self.asked.append(text)
        if not self.allows:
            raise Left("not allowed")


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("commission_peer"))


@contextmanager
def site_at(peer: Path, folder: Path, hand: Somebody, *options: str) -> Iterator[SiteByHand]:
    controller = Controller(peer, folder)
    controller.start(*options)
    if isinstance(hand, AtTheEnable):
        hand.controller = controller
    try:
        rig = Rig(Link(Bus("slcan", str(controller.path), None, ())))
        with SiteByHand(rig, hand, Folder(folder / "rig"), LIMIT_mA) as site:
            yield site
    finally:
        controller.stop()


def is_safe(site: SiteByHand) -> bool:
    """Which here is 0 mA."""
    return site.rig.read(DEMAND) == 0 and site.rig.read("status/state") != "RUN"


@pytest.fixture
def idle(peer: Path, tmp_path: Path) -> Iterator[tuple[SiteByHand, Somebody]]:
    """A controller that OperatorCommand enables, with a trial current and nobody at the enable."""
    hand = Somebody()
    with site_at(peer, tmp_path, hand, "--operator") as site:
        give(site.rig, limits(LIMIT_mA, 160, 0))
        yield site, hand


@pytest.mark.slow
def test_it_is_armed_when_that_is_allowed_and_safe_after(idle) -> None:
    site, hand = idle
    assert is_safe(site) and hand.asked == []
    with site.armed("a trial"):
        assert "up to 0.8 A through the coil" in hand.asked[0]
        assert site.rig.read("status/state") == "RUN" and site.rig.read(DEMAND) == 160
    assert is_safe(site) and site.rig.read("status/fault") == "NONE"


@pytest.mark.slow
@pytest.mark.parametrize("end", [KeyboardInterrupt, Left, ValueError])
def test_whatever_ends_it_leaves_the_safe_current(idle, end: type[BaseException]) -> None:
    site, _ = idle
    with pytest.raises(end), site.armed("a trial"):
        assert site.rig.read(DEMAND) == 160
        raise end
    assert is_safe(site)


@pytest.mark.slow
def test_without_a_yes_nothing_is_driven(peer: Path, tmp_path: Path) -> None:
    with site_at(peer, tmp_path, Somebody(allows=False), "--operator") as site:
        with pytest.raises(Left), site.armed("a trial"):
            raise AssertionError("it was armed")
        assert site.rig.read("status/is_enabled") == 0 and is_safe(site)


@pytest.mark.slow
def test_an_enable_that_stays_is_met_with_the_emergency_stop(peer: Path, tmp_path: Path) -> None:
    with site_at(peer, tmp_path, Somebody()) as site:  # its board gives the enable
        with pytest.raises(BenchFailure, match="the enable is still there"), site.armed("a trial"):
            assert site.rig.read("status/state") == "RUN"
        assert site.rig.read("status/fault") == "ESTOP" and is_safe(site)


class AtTheEnable(Somebody):
    """Turns the board's enable when that is asked for."""

    controller: Controller

    def do(self, text: str) -> None:
        super().do(text)
        if "your enable away" in text or "give the enable" in text:
            self.controller.turn_enable()


@pytest.mark.slow
def test_an_enable_at_hand_is_asked_for_and_taken_away_each_time(
    peer: Path, tmp_path: Path
) -> None:
    hand = AtTheEnable()
    with site_at(peer, tmp_path, hand, "--idle") as site:
        give(site.rig, limits(LIMIT_mA, 160, 0))
        for _ in range(2):
            hand.asked.clear()
            with site.armed("a trial"):
                assert site.rig.read("status/state") == "RUN" and site.rig.read(DEMAND) == 160
            assert is_safe(site) and site.rig.read("status/fault") == "NONE"
            assert "up to 0.8 A" in hand.asked[0]
            assert "give the enable" in hand.asked[1] and "enable away" in hand.asked[2]
            give(site.rig, {"constant_current_mA": 160})  # a latched fault would refuse it


@pytest.mark.slow
def test_a_stop_that_nobody_answers_keeps_to_its_cycle(
    peer: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames, sent = StopFrames(load()), []
    send = Link.send

    def counted(link: Link, frame_id: int, data: bytes) -> object:
        if frame_id == frames.frame_id:
            sent.append(time.monotonic())
        return send(link, frame_id, data)

    monkeypatch.setattr(Link, "send", counted)
    with site_at(peer, tmp_path, Somebody(), "--silent") as site:
        with pytest.raises(BenchFailure, match="use its own switch"), site.armed("a trial"):
            assert site.rig.read("status/state") == "RUN"
    assert len(sent) > 0.7 * STOP_S / frames.cycle_s


@pytest.mark.slow
@pytest.mark.parametrize("end", [None, KeyboardInterrupt])
def test_a_trial_gives_back_what_it_took(
    idle, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: type[BaseException] | None
) -> None:
    site, _ = idle
    give(
        site.rig,
        {"law": "off", "constant_current_mA": 70, "unlock_current_mA": 500, "safe_current_mA": 30,
         "max_current_mA": 800},
    )  # fmt: skip
    folder = Folder(tmp_path / "rig")
    folder.save()
    work = Work(Wants(drive_V=0.1, max_current_A=0.6), folder, lambda _: None, lambda: site)
    # The peer's sensor is not shaken by orders.
    monkeypatch.setattr(wiring, "sensed", lambda _: {"noise_counts": 1.0, "shaken_ratio": 9.0})
    site.limit_mA = 400
    laws: list[object] = []

    def driven(work: Work, trial_mA: int) -> dict[str, object]:
        laws.append(site.rig.read("parameters/law"))
        if end is not None:
            raise end
        return {"demand_mA": trial_mA, "measured_mA": trial_mA, "lag_s": 0.0123}

    monkeypatch.setattr(wiring, "driven", driven)
    with pytest.raises(end) if end else nullcontext():
        wiring.run(work)
    names = ("law", "constant_current_mA", "unlock_current_mA", "safe_current_mA", "max_current_mA")
    values = [site.rig.read(f"parameters/{name}") for name in names]
    assert laws == ["constant"] and values == ["off", 70, 400, 30, 400]
    assert folder.settings["law"] == "off"
    assert site.rig.read("parameters/current_lag_ms") == (12 if end is None else 5)


@pytest.mark.slow
def test_pulses_that_are_refused_are_told_with_what_is_in_effect(idle, tmp_path: Path) -> None:
    site, _ = idle
    tuned = tmp_path / "rig/tuned"
    tuned.mkdir(parents=True)
    shutil.copy(ROOT / "firmware/plants/squeeze_2012/pulses.phase.toml", tuned)
    folder = Folder(tmp_path / "rig")
    currents = ("max_current_mA", "unlock_current_mA", "constant_current_mA")
    parameters = {**dict.fromkeys(currents, 700), "law": "fuzzy"}  # which takes no pulses
    folder.results |= {"wiring": {"lag_s": None}, "tune": {"parameters": parameters}}
    with pytest.raises(BenchFailure, match="runs law fuzzy.*in effect already, not kept"):
        load_step.run(Work(Wants(), folder, lambda _: None, lambda: site))
    assert site.rig.read("parameters/max_current_mA") == 700
    assert "load" not in folder.results


@pytest.mark.slow
def test_a_current_that_is_played_needs_a_yes(idle, peer: Path, tmp_path: Path) -> None:
    site, hand = idle
    (tmp_path / "rig").mkdir()
    line = timeline(SweepPlan(rate_Hz=200, high_Hz=20.0, sweep_s=5.0, dwell_Hz=(5.0,),
                              max_current_A=0.8))  # fmt: skip
    hand.allows = False
    with pytest.raises(Left):
        site.played(line, "recording", has_damper=True)
    assert len(hand.asked) == 1 and "up to 0.8 A through the coil" in hand.asked[0]
    still = replace(line, current_A=np.zeros_like(line.current_A))
    with pytest.raises(UsageError, match="no such file"):
        site.played(still, "first_look", has_damper=True)  # a yes is not needed


@pytest.mark.slow
def test_a_recording_of_another_line_is_not_taken_for_this_one(idle, tmp_path: Path) -> None:
    site, hand = idle
    rig = tmp_path / "rig"
    rig.mkdir()
    plan = SweepPlan(rate_Hz=200, high_Hz=20.0, sweep_s=5.0, dwell_Hz=(5.0,))
    recording = rig / "recording.csv"
    with pytest.raises(UsageError):
        site.played(timeline(plan), "recording", has_damper=True)
    recording.write_text("of this line\n")
    count = len(hand.asked)
    site.played(timeline(plan), "recording", has_damper=True)
    assert len(hand.asked) == count  # nobody is asked again
    with pytest.raises(UsageError, match="recording.csv: no such file"):
        site.played(timeline(replace(plan, drive_V=0.2)), "recording", has_damper=True)
    assert (rig / "recording_older.csv").read_text() == "of this line\n"
    recording.write_text("of that line\n")
    to_play(rig, "recording").unlink()  # as --from excite does
    with pytest.raises(UsageError, match="recording.csv: no such file"):
        site.played(timeline(replace(plan, drive_V=0.2)), "recording", has_damper=True)


@pytest.mark.slow
def test_a_damper_that_was_off_is_mounted_again(idle, tmp_path: Path) -> None:
    site, hand = idle
    for damper in (None, "mr.toml"):
        folder = Folder(tmp_path / "rig")
        folder.save()
        wants = Wants(drive_V=0.1, max_current_A=0.8, first_mode_Hz=9.0, damper=damper)
        work = Work(wants, folder, lambda _: None, lambda: site)
        with pytest.raises(UsageError):
            excite.run(work)
        (tmp_path / "rig/recording.csv").write_text("recorded\n")
        assert excite.run(work)["has_damper"] == (damper is None)
        assert (hand.asked[-1] == "mount the damper again") == (damper is not None)


@pytest.mark.slow
def test_a_shaker_is_asked_for_once_and_a_recording_has_to_be_there(idle, tmp_path: Path) -> None:
    site, hand = idle
    (tmp_path / "rig").mkdir()
    for _ in range(2):
        site.shake(9.0, 0.2)
    site.shake(9.0, 0.0)
    assert hand.asked[0] == "shake it with a sine of 9 Hz, 0.2 V" and len(hand.asked) == 2
    line = timeline(SweepPlan(rate_Hz=200, high_Hz=20.0, sweep_s=5.0, dwell_Hz=(5.0,)))
    with pytest.raises(UsageError, match="recording.csv: no such file"):
        site.played(line, "recording", has_damper=False)
    assert hand.asked[-1].startswith("Take the damper off. Play drive_V")
    assert (tmp_path / "rig/recording_to_play.csv").read_text().startswith("time_s,drive_V")
    (tmp_path / "rig/recording.csv").write_text("time_s\n")
    site.played(line, "recording", has_damper=True)


def test_on_a_bus_the_limit_has_to_be_named(tmp_path: Path) -> None:
    def nowhere(*_: object) -> SiteByHand:
        raise AssertionError("nothing is opened")

    order = Order(tmp_path / "rig", {"drive_V": 0.1}, None, None, False)
    with pytest.raises(UsageError, match="--max-current"):
        commission(order, lambda _: None, nowhere, lambda _: None)


@pytest.mark.slow
def test_leaving_at_a_prompt_says_how_to_go_on(quiesce, peer: Path, tmp_path: Path) -> None:
    """Nobody is at this terminal: the first thing that is asked for is left."""
    controller = Controller(peer, tmp_path)
    controller.start("--operator")
    try:
        done = quiesce("commission", "rig", "--bus", controller.bus, "--max-current", "1",
                       "--drive", "0.1", "--base-plant",
                       ROOT / "sim_hil/data/plants/squeeze_2012.toml")  # fmt: skip
    finally:
        controller.stop()
    assert done.returncode == 130 and "Traceback" not in done.stderr
    assert "goes on with the step" in done.stderr
    listed = quiesce("commission", "rig", "--list")
    assert listed.returncode == 0 and "wiring" in listed.stdout
