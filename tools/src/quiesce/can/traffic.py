"""What was seen on a bus: counts, rates, losses by the alive counters, for one message each."""

from bisect import bisect_left
from dataclasses import dataclass, field
from typing import Any

from quiesce.can.database import Database, Message
from quiesce.can.e2e import JUMPED, OK, Receiver

UNKNOWN = "unknown"
WRONG_LENGTH = "length"


@dataclass
class Seen:
    """Frames of one message."""

    message: Message
    count: int = 0
    wrong_length: int = 0
    first_s: float = 0.0
    last_s: float = 0.0
    longest_s: float = 0.0  # between two frames
    data: bytes = b""  # of the last frame that can be trusted
    receiver: Receiver | None = None
    times_s: list[float] = field(default_factory=list)  # of the last second

    @property
    def lost(self) -> int | None:
        """Frames missing by the alive counter; None: it has none that could tell."""
        is_judged = self.receiver and not self.receiver.layout.alive_is_free
        return self.receiver.lost if is_judged and self.receiver else None

    @property
    def wrong_crc(self) -> int:
        return self.receiver.wrong_crc if self.receiver else 0

    @property
    def repeated(self) -> int:
        return self.receiver.repeated if self.receiver else 0

    @property
    def period_ms(self) -> float | None:
        """Mean time from frame to frame."""
        if self.count < 2:
            return None
        return 1000.0 * (self.last_s - self.first_s) / (self.count - 1)

    def rate_Hz(self, now_s: float) -> float:
        """Frames of the last second."""
        del self.times_s[: bisect_left(self.times_s, now_s - 1.0)]
        return float(len(self.times_s))

    def take(self, time_s: float, data: bytes) -> str:
        """OK, or what is wrong with the frame."""
        if self.count:
            self.longest_s = max(self.longest_s, time_s - self.last_s)
        else:
            self.first_s = time_s
        self.count += 1
        self.last_s = time_s
        if len(data) != self.message.length:
            self.wrong_length += 1
            return WRONG_LENGTH
        verdict = self.receiver.take(data) if self.receiver else OK
        if verdict in (OK, JUMPED):
            self.data = data
        return verdict


class Traffic:
    """Everything since the start. is_timed: keep arrival times for rate_Hz."""

    def __init__(self, database: Database, is_timed: bool = False) -> None:
        self.database = database
        self.seen: dict[int, Seen] = {}
        self.unknown: dict[int, int] = {}
        self.errors = 0  # error frames
        self.frames = 0
        self._is_timed = is_timed

    def take(self, frame: Any) -> str:
        """Of a can.Message: OK, JUMPED, UNKNOWN, or what is wrong."""
        self.frames += 1
        if frame.is_error_frame:
            self.errors += 1
            return UNKNOWN
        message = None if frame.is_extended_id else self.database.by_id.get(frame.arbitration_id)
        if message is None or frame.is_remote_frame:
            self.unknown[frame.arbitration_id] = self.unknown.get(frame.arbitration_id, 0) + 1
            return UNKNOWN
        seen = self.seen.get(message.frame_id)
        if seen is None:
            layout = message.protection
            seen = Seen(message, receiver=Receiver(layout) if layout else None)
            self.seen[message.frame_id] = seen
        if self._is_timed:
            seen.times_s.append(frame.timestamp)
        return seen.take(frame.timestamp, bytes(frame.data))

    def of(self, name: str) -> Seen | None:
        return self.seen.get(self.database.by_name[name].frame_id)

    def values(self, name: str) -> dict[str, Any]:
        """Signals of the last trusted frame; empty where there is none."""
        seen = self.of(name)
        if seen is None or not seen.data:
            return {}
        return self.database.decode(seen.message.frame_id, seen.data)

    def forget(self) -> None:
        """After a gap: counters and intervals begin anew."""
        for seen in self.seen.values():
            if seen.receiver:
                seen.receiver.forget()

    def total(self, name: str) -> int:
        """Sum of lost, wrong_crc, repeated or wrong_length."""
        return sum(getattr(seen, name) or 0 for seen in self.seen.values())

    def summary(self) -> dict[str, Any]:
        """What a report says, as values of JSON."""
        return {
            "frames": self.frames,
            "unknown": sum(self.unknown.values()),
            "unknown_ids": [f"0x{one:X}" for one in sorted(self.unknown)],
            "wrong_crc": self.total("wrong_crc"),
            "wrong_length": self.total("wrong_length"),
            "lost": self.total("lost"),
            "repeated": self.total("repeated"),
            "error_frames": self.errors,
        }


def summary_line(summary: dict[str, Any]) -> str:
    ids = summary["unknown_ids"]
    shown = ", ".join(ids[:6]) + (" ..." if len(ids) > 6 else "")
    words = [f"{summary['frames']} frames"]
    words.append(f"{summary['unknown']} of unknown ids" + (f" ({shown})" if ids else ""))
    for name, text in (
        ("wrong_crc", "wrong CRC"),
        ("wrong_length", "wrong length"),
        ("lost", "lost by the alive counters"),
        ("repeated", "repeated"),
    ):
        words.append(f"{summary[name]} {text}")
    if summary["error_frames"]:
        words.append(f"{summary['error_frames']} error frames")
    return ", ".join(words)
