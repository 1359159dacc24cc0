"""Every figure of a pair of channels, before and after, with what may be said of the difference."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.before_after import levels, thirds
from quiesce.before_after.integrate import fading_samples, integrated
from quiesce.before_after.levels import Estimate, Ratio
from quiesce.before_after.motion import ACCELERATION, MOTIONS, VELOCITY, Motion
from quiesce.before_after.pairs import SIDES, Pair, Side, together
from quiesce.before_after.response import (
    LEAST_AVERAGES,
    Response,
    Segments,
    answer_rms,
    response,
    segment_samples,
    segments,
)
from quiesce.before_after.sampling import MIN_SAMPLES
from quiesce.compare.weighting import weighted
from quiesce.compare.zones import Machine

# The band of a report where none is stated: from so many periods of the shortest record on, and up
# to this part of the lowest rate.
LEAST_LOW_Hz = 0.5
PERIODS = 20.0
HIGH_PART = 0.4
# Bands of the reference with this part of its power are compared.
TELLING_PART = 0.05
SAME_INPUT_dB = 1.0
GOOD_COHERENCE = 0.5


@dataclass(frozen=True)
class Settings:
    """machine: whose zones; has_comfort: whether somebody sits on it."""

    band_Hz: tuple[float, float]
    machine: Machine | None = None
    has_comfort: bool = False


@dataclass(frozen=True)
class Figure:
    """estimates: of both sides, with their errors; None: how sure it is is not known."""

    quantity: str
    unit: str
    before: float
    after: float
    estimates: tuple[Estimate, Estimate] | None = None

    @property
    def change(self) -> float:
        """after / before."""
        return self.after / self.before if self.before else math.inf

    @property
    def ratio(self) -> Ratio | None:
        return levels.ratio(*self.estimates) if self.estimates else None


@dataclass(frozen=True)
class Answer:
    """To the reference, in either recording. normalised: the RMS that the channel would have under
    one and the same input, the mean of both."""

    responses: tuple[Response, Response]
    normalised: tuple[Estimate, Estimate]
    unit: str


@dataclass(frozen=True)
class Found:
    """Of one pair. bands: RMS by the index of the third octave, before and after. block_rms: of
    the twentieths of each record, in the motion's own unit."""

    pair: Pair
    figures: list[Figure]
    bands: dict[int, tuple[Estimate, Estimate]]
    spectra: tuple[Segments, Segments]
    block_rms: tuple[np.ndarray, np.ndarray]
    zones: tuple[str, str] | None
    answer: Answer | None
    doubts: list[str]

    def figure(self, quantity: str) -> Figure | None:
        return next((one for one in self.figures if one.quantity == quantity), None)


def band_of(pairs: list[Pair], low_Hz: float | None, high_Hz: float | None) -> tuple[float, float]:
    """As stated, else by the shortest record and the lowest rate. UsageError where the recordings
    cannot tell anything in it."""
    shortest_s = min(side.duration_s for pair in pairs for side in pair.sides)
    rate_Hz = min(side.rate_Hz for pair in pairs for side in pair.sides)
    low = max(LEAST_LOW_Hz, PERIODS / shortest_s) if low_Hz is None else low_Hz
    high = HIGH_PART * rate_Hz if high_Hz is None else high_Hz
    if high > rate_Hz / 2.0:
        raise UsageError(
            f"--band: {high:g} Hz is above half of the lowest sampling rate, {rate_Hz:.6g} Hz"
        )
    if low >= high:
        raise UsageError(
            f"the band {low:.3g} .. {high:.3g} Hz is empty; record for longer, or state --band"
        )
    for pair in pairs:
        for side, one in zip(SIDES, pair.sides, strict=True):
            if len(one.values) < 2 * fading_samples(one.rate_Hz, low) + MIN_SAMPLES:
                raise UsageError(
                    f"{pair.name} {side}: {one.duration_s:.3g} s are too short for a band from "
                    f"{low:.3g} Hz on; state --band LOW HIGH, LOW larger, or record for longer"
                )
    return low, high


def found(pair: Pair, reference: Pair | None, settings: Settings) -> Found:
    """All of it. UsageError as together() has it."""
    band_Hz = settings.band_Hz
    figures, doubts = list(_motions(pair, settings)), list(pair.doubts)
    before, after = (_moved(side, pair.motion, pair.motion, band_Hz) for side in pair.sides)
    for side, values in zip(SIDES, (before, after), strict=True):
        doubts += [f"{side}: {line}" for line in levels.unsteady(values)]
    zoned, of_zone = _zoned(pair, settings.machine)
    answer, of_answer = _answer(pair, reference, band_Hz)
    figures += [zoned] if zoned else []
    figures += [_comfort(pair, band_Hz[0])] if _is_felt(pair, settings) else []
    figures += _answer_figures(answer, pair.motion.unit, band_Hz) if answer else []
    return Found(
        pair=pair,
        figures=figures,
        bands=_bands(pair, band_Hz),
        spectra=_spectra(pair),
        block_rms=(_block_rms(pair.motion, before), _block_rms(pair.motion, after)),
        zones=_zones(zoned, settings.machine),
        answer=answer,
        doubts=[*doubts, *of_zone, *of_answer],
    )


def _block_rms(motion: Motion, values: np.ndarray) -> np.ndarray:
    return motion.per_si * np.sqrt(np.mean(levels.blocks(values) ** 2, axis=1))


def _spectra(pair: Pair) -> tuple[Segments, Segments]:
    size = segment_samples(tuple(len(side.values) for side in pair.sides), pair.before.rate_Hz)
    before, after = (segments(side.values, side.rate_Hz, size) for side in pair.sides)
    return before, after


def _is_felt(pair: Pair, settings: Settings) -> bool:
    return settings.has_comfort and pair.motion is ACCELERATION


def _zones(zoned: Figure | None, machine: Machine | None) -> tuple[str, str] | None:
    if zoned is None or machine is None:
        return None
    return machine.zone(zoned.before), machine.zone(zoned.after)


def _moved(side: Side, own: Motion, motion: Motion, band_Hz: tuple[float, float]) -> np.ndarray:
    return integrated(side.values, side.rate_Hz, motion.order - own.order, *band_Hz)


def _motions(pair: Pair, settings: Settings) -> Iterator[Figure]:
    """RMS and peaks of what is measured and of its integrals; the shape of what is measured."""
    for motion in MOTIONS[pair.motion.order :]:
        sides = [_moved(side, pair.motion, motion, settings.band_Hz) for side in pair.sides]
        sides = [motion.per_si * values for values in sides]
        yield _estimated(f"{motion.name}_rms", motion.unit, [levels.rms(one) for one in sides])
        peaks = levels.typical_peaks(*sides)
        yield _estimated(f"{motion.name}_typical_peak", motion.unit, peaks)
        yield Figure(f"{motion.name}_peak", motion.unit, *map(levels.peak, sides))
        if motion is pair.motion:
            yield Figure("crest", "", *map(levels.crest, sides))
            yield Figure("kurtosis", "", *map(levels.kurtosis, sides))


def _estimated(quantity: str, unit: str, sides: Sequence[Estimate]) -> Figure:
    before, after = sides
    return Figure(quantity, unit, before.value, after.value, (before, after))


def _zoned(pair: Pair, machine: Machine | None) -> tuple[Figure | None, list[str]]:
    """RMS velocity in the zones' band, of what is below HIGH_PART of the rate, and doubts about
    it."""
    if machine is None or pair.motion.order > VELOCITY.order:
        return None, []
    low_Hz, high_Hz = machine.band_Hz
    measured_Hz = min(high_Hz, HIGH_PART * min(side.rate_Hz for side in pair.sides))
    shortest = min(
        len(side.values) - 2 * fading_samples(side.rate_Hz, low_Hz) for side in pair.sides
    )
    if measured_Hz <= low_Hz or shortest < MIN_SAMPLES:
        return None, [f"no zone: the recordings do not reach beyond {low_Hz:g} Hz for long enough"]
    doubts = []
    if measured_Hz < high_Hz:
        doubts = [f"zone: of {low_Hz:g} to {high_Hz:g} Hz only what is below {measured_Hz:.4g} Hz"]
    sides = [
        VELOCITY.per_si * _moved(side, pair.motion, VELOCITY, (low_Hz, measured_Hz))
        for side in pair.sides
    ]
    return _estimated(
        "zone_velocity_rms", VELOCITY.unit, [levels.rms(one) for one in sides]
    ), doubts


def _comfort(pair: Pair, low_Hz: float) -> Figure:
    """RMS through Wk of ISO 2631-1, as if the channel were vertical."""
    sides = []
    for side in pair.sides:
        edge = fading_samples(side.rate_Hz, low_Hz)
        values = weighted(side.values - side.values.mean(), side.rate_Hz)
        sides.append(levels.rms(values[edge : len(values) - edge]))
    return _estimated("weighted_rms", ACCELERATION.unit, sides)


def _bands(pair: Pair, band_Hz: tuple[float, float]) -> dict[int, tuple[Estimate, Estimate]]:
    sides = [thirds.levels(side.values, side.rate_Hz, *band_Hz) for side in pair.sides]
    scale = pair.motion.per_si
    return {
        index: (
            replace(before, value=scale * before.value),
            replace(after, value=scale * after.value),
        )
        for index, before in sides[0].items()
        if (after := sides[1].get(index)) is not None and before.value > 0.0
    }


def _answer(
    pair: Pair, reference: Pair | None, band_Hz: tuple[float, float]
) -> tuple[Answer | None, list[str]]:
    if reference is None:
        return None, []
    both = [
        together(one, other, pair.name)
        for one, other in zip(pair.sides, reference.sides, strict=True)
    ]
    size = segment_samples(tuple(len(one.values) for one, _ in both), both[0][0].rate_Hz)
    parts = [
        (segments(one.values, one.rate_Hz, size), segments(other.values, other.rate_Hz, size))
        for one, other in both
    ]
    freq_Hz = parts[0][0].freq_Hz
    inside = (freq_Hz >= band_Hz[0]) & (freq_Hz <= band_Hz[1])
    if not inside.any():
        raise UsageError(
            f"--band: no line of the spectrum of {pair.name} is in it, which has one every "
            f"{freq_Hz[1]:.3g} Hz; widen it, or record for longer"
        )
    density = np.mean([other.density() for _, other in parts], axis=0)
    scale = pair.motion.per_si / reference.motion.per_si
    answers = [
        replace(one, value=one.value * pair.motion.per_si)
        for one in (answer_rms(other, own, density, inside) for own, other in parts)
    ]
    responses = [_scaled(response(other, own), scale) for own, other in parts]
    same = pair.motion is reference.motion
    unit = "" if same else f"{pair.motion.unit} / {reference.motion.unit}"
    answer = Answer((responses[0], responses[1]), (answers[0], answers[1]), unit)
    return answer, _answer_doubts(responses, inside)


def _scaled(one: Response, scale: float) -> Response:
    return replace(one, h1=one.h1 * scale, h2=one.h2 * scale, reach=one.reach * scale)


def _answer_doubts(responses: list[Response], inside: np.ndarray) -> list[str]:
    doubts = []
    for side, one in zip(SIDES, responses, strict=True):
        if one.averages < LEAST_AVERAGES:
            doubts.append(f"{side}: transmissibility by {one.averages:.1f} averages only")
        poor = float(np.mean(one.coherence[inside] < GOOD_COHERENCE))
        if poor > 0.5:
            doubts.append(
                f"{side}: coherence with the reference is below {GOOD_COHERENCE:g} over "
                f"{100 * poor:.0f} % of the band; the channel has other sources, or the reference "
                "is no input of it"
            )
    return doubts


def _answer_figures(answer: Answer, unit: str, band_Hz: tuple[float, float]) -> Iterator[Figure]:
    yield _estimated("normalised_rms", unit, answer.normalised)
    peaks = [peak_of(one, band_Hz) for one in answer.responses]
    if all(peak is not None for peak in peaks):
        yield Figure("transmissibility_peak", answer.unit, *(peak[1] for peak in peaks))


def peak_of(one: Response, band_Hz: tuple[float, float]) -> tuple[float, float] | None:
    """Frequency and |H1| of the largest one in the band that is no chance; None without any."""
    inside = (one.freq_Hz >= band_Hz[0]) & (one.freq_Hz <= band_Hz[1])
    inside &= one.coherence > max(one.chance_coherence, GOOD_COHERENCE)
    if not inside.any():
        return None
    size = np.where(inside, np.abs(one.h1), 0.0)
    at = int(np.argmax(size))
    return float(one.freq_Hz[at]), float(size[at])


def input_doubts(reference: Pair, band_Hz: tuple[float, float]) -> list[str]:
    """Lines about how the input differs between the recordings."""
    sides = [_moved(side, reference.motion, reference.motion, band_Hz) for side in reference.sides]
    change = levels.ratio(*(levels.rms(one) for one in sides))
    lines = []
    if change.is_certain or abs(change.change_dB) > SAME_INPUT_dB:
        lines.append(
            f"the input differs: RMS of {reference.name} after is {100 * change.value:.0f} % "
            f"({100 * change.low:.0f} to {100 * change.high:.0f}) of that before; the figures "
            "'under the same input' allow for it, all others do not"
        )
    bands = _bands(reference, band_Hz)
    total = sum(before.value**2 for before, _ in bands.values())
    changes = {
        index: levels.ratio(before, after)
        for index, (before, after) in bands.items()
        if before.value**2 > TELLING_PART * total
    }
    worst = max(changes, key=lambda index: abs(changes[index].change_dB), default=None)
    if worst is not None and changes[worst].is_certain:
        dB = changes[worst].change_dB
        if abs(dB) > SAME_INPUT_dB:
            lines.append(
                f"the spectrum of the input differs: by {dB:+.1f} dB in the third-octave band of "
                f"{thirds.nominal_Hz(worst):g} Hz"
            )
    return lines
