"""A real controller on a bus: what arms it asks first, and whatever ends that leaves it safe."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from can_bus import Controller, build_peer
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.can.buses import Bus
from quiesce.can.link import Link
from quiesce.commission.by_hand import SiteByHand
from quiesce.commission.folder import Folder
from quiesce.commission.hand import Left
from quiesce.commission.run import Order, commission
from quiesce.commission.site import give
from quiesce.commission.steps.wiring import limits
from quiesce.commission.wants import Wants
from quiesce.plant_id.sweep import SweepPlan, timeline
from quiesce.rig import Rig

LIMIT_mA = 800
DEMAND = "current_demand/current_cmd_mA"


class Somebody:
    """Does all that is asked, and keeps it."""

    def __init__(self, allows: bool = True) -> None:
        self.asked: list[str] = []
        self._allows = allows

    def do(self, text: str) -> None:
        self.asked.append(text)

    def allow(self, text: str) -> None:
        self.asked.append(text)
        if not self._allows:
            raise Left("not allowed")


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("commission_peer"))


@contextmanager
def site_at(peer: Path, folder: Path, hand: Somebody, *options: str) -> Iterator[SiteByHand]:
    controller = Controller(peer, folder)
    controller.start(*options)
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
        give(site.rig, limits(LIMIT_mA, 160))
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
        with site.armed("a trial"):
            assert site.rig.read("status/state") == "RUN"
        assert site.rig.read("status/fault") == "ESTOP" and is_safe(site)


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
    def no_bus() -> Rig:
        raise AssertionError("nothing is opened")

    order = Order(tmp_path / "rig", Wants(drive_V=0.1), None, None, False)
    with pytest.raises(UsageError, match="--max-current"):
        commission(order, Somebody(), lambda _: None, no_bus, lambda _: None)


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
