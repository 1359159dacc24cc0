"""`quiesce can monitor`: what the controller does, live."""

import argparse
import sys
import time
from typing import Any

from quiesce.base.command import finite_number
from quiesce.base.table import format_table
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.can.options import check_seconds

EPILOG = """examples:
  quiesce can monitor --bus socketcan:can0
  quiesce can monitor --bus slcan:/dev/ttyACM0 | tee log.txt

A table on a terminal; one line a second where stdout is none. Only listens. A bus that is lost is
opened again; values then show their age. Ctrl-C ends it.
"""

REDRAW_S = 0.25
LINE_S = 1.0
OLD_S = 1.0
HOME_AND_CLEAR = "\x1b[H\x1b[J"


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "monitor",
        help="what the controller does, live",
        description="Show state, fault, frequency, vibration, currents, and the messages.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--seconds", type=finite_number, metavar="T", help="how long (until Ctrl-C)"
    )
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.stopping import until_stopped

    if args.seconds is not None:
        check_seconds("--seconds", args.seconds)
    bus, database = bus_of(args), load()
    is_terminal = sys.stdout.isatty()
    with until_stopped() as stop, Link(bus) as link:
        view = View(link, database)
        end_s = None if args.seconds is None else time.monotonic() + args.seconds
        every_s = REDRAW_S if is_terminal else LINE_S
        next_s = time.monotonic() + every_s
        while not stop.is_set() and (end_s is None or time.monotonic() < end_s):
            view.take(link.receive(min(0.05, max(0.0, next_s - time.monotonic()))))
            if time.monotonic() >= next_s:
                next_s += every_s
                now_s = time.time()
                text = HOME_AND_CLEAR + view.table(now_s) if is_terminal else view.line(now_s)
                print(text, flush=True)
    return 0


def age_text(age_s: float) -> str:
    return f"{age_s * 1000:.0f} ms" if age_s < OLD_S else f"{age_s:.1f} s"


class View:
    """The last values and how old they are."""

    def __init__(self, link: Any, database: Any) -> None:
        from quiesce.can.traffic import Traffic

        self._link = link
        self._traffic = Traffic(database, is_timed=True)
        self._lost = ""
        self._losses = 0

    def take(self, event: Any) -> None:
        if event is None:
            return
        if hasattr(event, "arbitration_id"):
            self._traffic.take(event)
        elif hasattr(event, "reason"):
            self._lost = event.reason
            self._losses += 1
        else:
            self._lost = ""
            self._traffic.forget()

    def value(self, message: str, signal: str, scale: float = 1.0) -> str:
        """Of the last trusted frame; '-' where there is none."""
        values = self._traffic.values(message)
        if not values:
            return "-"
        value = values[signal]
        return f"{value * scale:.3f}" if isinstance(value, int) else str(value)

    def age_s(self, now_s: float) -> float | None:
        """Of the last Status; None: there was none."""
        seen = self._traffic.of("Status")
        return None if seen is None else max(0.0, now_s - seen.last_s)

    def bus_text(self, now_s: float) -> str:
        if self._lost:
            return f"BUS LOST ({self._lost}), opening it again"
        age_s = self.age_s(now_s)
        if age_s is None:
            return "no controller so far"
        return f"NO STATUS for {age_text(age_s)}" if age_s > OLD_S else "ok"

    def line(self, now_s: float) -> str:
        rate_Hz = sum(seen.rate_Hz(now_s) for seen in self._traffic.seen.values())
        clock = time.strftime("%H:%M:%S", time.localtime(now_s))
        return (
            f"{clock} {self.value('Status', 'state')} fault {self.value('Status', 'fault')} "
            f"{self.value('Motion', 'freq_uHz', 1e-6)} Hz "
            f"rms {self.value('Status', 'rms_um_s2', 1e-6)} m/s2 "
            f"cmd {self.value('CurrentDemand', 'current_cmd_mA', 1e-3)} A "
            f"meas {self.value('CurrentMeasured', 'current_meas_mA', 1e-3)} A "
            f"{rate_Hz:.0f} frames/s lost {self._traffic.total('lost')} "
            f"crc {self._traffic.total('wrong_crc')} "
            f"shed {self.count('CanShed', 'unsent_telemetry')} bus {self.bus_text(now_s)}"
        )

    def table(self, now_s: float) -> str:
        is_valid = self._traffic.values("Status").get("freq_is_valid")
        doubt = "" if is_valid else " (not valid now)"
        lines = [
            f"bus        {self._link.bus.name}: {self.bus_text(now_s)}"
            + (f"; lost {self._losses} times" if self._losses else ""),
            f"state      {self.value('Status', 'state')}, fault {self.value('Status', 'fault')}",
            f"frequency  {self.value('Motion', 'freq_uHz', 1e-6)} Hz{doubt}",
            f"vibration  {self.value('Status', 'rms_um_s2', 1e-6)} m/s2 RMS, displacement "
            f"{self.value('Motion', 'displacement_amp_nm', 1e-3)} um",
            *(self.current(number) for number in self.dampers()),
            self.loop(),
            *self.cycles(),
            self.unsent(),
            "",
            self.messages(now_s),
        ]
        others = sum(self._traffic.unknown.values())
        if others or self._link.malformed:
            lines.append(f"{others} frames of unknown ids, {self._link.malformed} malformed lines")
        return "\n".join(lines)

    def loop(self) -> str:
        """How the ticks come; targets that cannot tell say 0."""
        return (
            f"ticks      {self.count('LoopTiming', 'overruns')} lost, at most "
            f"{self.count('LoopTiming', 'lateness_max_us')} us late and "
            f"{self.count('LoopTiming', 'work_max_us')} us of work in the last second"
        )

    def cycles(self) -> list[str]:
        """What the loop takes of the processor, where that has a cycle counter."""
        values = self._traffic.values("LoopCycles")
        if not values:
            return []
        return [
            f"processor  {values['work_max_cycles']} cycles a tick and "
            f"{values['interrupt_max_cycles']} an interrupt of the current loop at most, of "
            f"{values['core_kHz'] / 1000:g} MHz"
        ]

    def unsent(self) -> str:
        """Frames that the controller could not send, since its start; counters wrap."""
        classes = ("demands", "answers", "telemetry")
        counts = (f"{self.count('CanShed', f'unsent_{one}')} {one}" for one in classes)
        return "not sent   " + ", ".join(counts)

    def count(self, message: str, signal: str) -> str:
        values = self._traffic.values(message)
        return str(values[signal]) if values else "-"

    def dampers(self) -> list[int]:
        """Those that are heard of, and the first."""
        heard = {seen.message for seen in self._traffic.seen.values()}
        numbers = {one.number for one in heard if one.kind in ("CurrentDemand", "CurrentMeasured")}
        return sorted({0} | numbers)

    def current(self, number: int) -> str:
        suffix = str(number) if number else ""
        return (
            f"current {suffix:2} "
            f"{self.value(f'CurrentDemand{suffix}', 'current_cmd_mA', 1e-3)} A demanded, "
            f"{self.value(f'CurrentMeasured{suffix}', 'current_meas_mA', 1e-3)} A measured"
        )

    def messages(self, now_s: float) -> str:
        rows = [
            [
                seen.message.name, f"0x{frame_id:03X}", seen.rate_Hz(now_s),
                age_text(max(0.0, now_s - seen.last_s)), seen.lost, seen.wrong_crc, seen.count,
            ]
            for frame_id, seen in sorted(self._traffic.seen.items())
        ]  # fmt: skip
        head = ["message", "id", "per s||.0f", "age", "lost", "crc", "count"]
        return format_table(head, rows, left=(0, 1))
