"""The excitations under which `./tools/benchmark control` judges a law: scenarios as data.

Times are in s, frequencies in Hz, drives in V; `seed` of a random force is part of the excitation,
that of the sensor's noise is given when a scenario runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomli_w

NOISE_mg = 0.5
LAST_s = 2.0  # steady state is measured over the last 2 s


@dataclass(frozen=True)
class Scenario:
    """A scenario file but for its plant. Tables are tuples of items, so that it can be a key."""

    name: str
    duration_s: float
    segments: tuple[tuple[tuple[str, Any], ...], ...]
    windows_s: tuple[tuple[float, float], ...]
    transient_s: tuple[float, float] | None = None  # start, end of its RMS displacement
    drive_V: float | None = None  # None: the plant's
    feed_current: bool = False
    faults: tuple[tuple[str, float, float], ...] = ()  # kind, start, duration

    def document(self, plant_file: Path) -> dict[str, Any]:
        """As the bench reads it (docs/howto/describe-a-plant.md)."""
        out: dict[str, Any] = {
            "schema": "quiesce-scenario", "version": 1, "name": self.name,
            "plant": str(plant_file), "duration_s": self.duration_s, "noise_mg": NOISE_mg,
            "feed_current": self.feed_current,
            "segment": [thawed(one) for one in self.segments],
            "window": [{"start_s": start, "end_s": end} for start, end in self.windows_s],
        }  # fmt: skip
        if self.faults:
            out["fault"] = [
                {"kind": kind, "t_s": t_s, "duration_s": duration_s}
                for kind, t_s, duration_s in self.faults
            ]
        if self.transient_s is not None:
            start_s, end_s = self.transient_s
            out["transient"] = {"start_s": start_s, "disp_end_s": end_s}
        if self.drive_V is not None:
            out["drive_V"] = self.drive_V
        return out

    def text(self, plant_file: Path) -> str:
        return tomli_w.dumps(self.document(plant_file))


def frozen(**items: Any) -> tuple[tuple[str, Any], ...]:
    return tuple(items.items())


def thawed(items: Any) -> Any:
    """A table of tuples as dictionaries and lists."""
    if isinstance(items, tuple) and items and all(is_item(one) for one in items):
        return {key: thawed(value) for key, value in items}
    if isinstance(items, tuple):
        return [thawed(one) for one in items]
    return items


def is_item(value: Any) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and isinstance(value[0], str)


def sine(freq_Hz: float, **more: float) -> tuple[tuple[str, Any], ...]:
    return frozen(kind="sine", freq_Hz=freq_Hz, **more)


def whole(name: str, duration_s: float, segment: tuple[tuple[str, Any], ...]) -> Scenario:
    """One segment, measured from rest to the end."""
    return Scenario(name, duration_s, (segment,), ((0.0, duration_s),))


def steady(freq_Hz: float, duration_s: float, drive_V: float | None = None) -> Scenario:
    """A sine from rest, measured over the last 2 s."""
    window_s = (duration_s - LAST_s, duration_s)
    return Scenario(f"{freq_Hz:g} Hz", duration_s, (sine(freq_Hz),), (window_s,), drive_V=drive_V)


def step(from_Hz: float, to_Hz: float, at_s: float) -> Scenario:
    """A change of frequency with continuous phase. Settling ends 6 s after it."""
    end_s = at_s + 6.0
    return Scenario(
        f"{from_Hz:g} to {to_Hz:g} Hz at {at_s:g} s",
        end_s,
        (sine(from_Hz, duration_s=at_s), sine(to_Hz)),
        ((at_s - LAST_s, at_s), (end_s - LAST_s, end_s)),
        transient_s=(at_s, at_s + 2.0),
    )


@dataclass(frozen=True)
class Chirp:
    """Linear in time, from rest."""

    from_Hz: float
    to_Hz: float
    slope_Hz_s: float

    def scenario(self) -> Scenario:
        duration_s = (self.to_Hz - self.from_Hz) / self.slope_Hz_s
        segment = frozen(
            kind="chirp", freq_Hz=self.from_Hz, end_freq_Hz=self.to_Hz, duration_s=duration_s
        )
        return whole(f"chirp {self.from_Hz:g} to {self.to_Hz:g} Hz", duration_s, segment)


def two_tones(freqs_Hz: Sequence[float], drive_V: float, duration_s: float) -> Scenario:
    """Equal parts of the drive; incommensurable phases do not matter, they drift."""
    tones = tuple(frozen(freq_Hz=freq_Hz, drive_V=drive_V / 2.0) for freq_Hz in freqs_Hz)
    name = " + ".join(f"{freq_Hz:g}" for freq_Hz in freqs_Hz) + " Hz"
    return whole(name, duration_s, frozen(kind="tones", tone=tones))


def random_force(
    low_Hz: float, high_Hz: float, drive_rms_V: float, seed: int, duration_s: float
) -> Scenario:
    segment = frozen(
        kind="random", low_Hz=low_Hz, high_Hz=high_Hz, drive_rms_V=drive_rms_V,
        seed=seed, duration_s=duration_s,
    )  # fmt: skip
    return whole(f"random {low_Hz:g} to {high_Hz:g} Hz", duration_s, segment)


def impulse(impulse_N_s: float, pulse_s: float, duration_s: float) -> Scenario:
    segment = frozen(kind="impulse", impulse_N_s=impulse_N_s, pulse_s=pulse_s)
    return whole("impulse", duration_s, segment)


def earthquake(
    name: str, file: Path, gain: float, time_scale: float, duration_s: float
) -> Scenario:
    """Recorded base acceleration. time_scale 5: five times as fast."""
    segment = frozen(
        kind="record", file=str(file.resolve()), time_column="t_s", accel_column="acc_m_s2",
        gain=gain, time_scale=time_scale,
    )  # fmt: skip
    return whole(name, duration_s, segment)


def scaled(scenario: Scenario, key: str, factor: float) -> Scenario:
    """Its only segment with that number multiplied."""
    (segment,) = scenario.segments
    changed = tuple((k, v * factor if k == key else v) for k, v in segment)
    return replace(scenario, segments=(changed,))
