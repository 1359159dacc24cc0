"""A report: two recordings read, paired, compared and judged."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.base.progress import Progress
from quiesce.before_after.figures import Found, Settings, band_of, found, input_doubts
from quiesce.before_after.files.open_file import sha256_of
from quiesce.before_after.files.source import Source
from quiesce.before_after.limits import Limit, Verdict, judged
from quiesce.before_after.motion import Wanted
from quiesce.before_after.pairs import SIDES, Pair, chosen, left_out, pair_of
from quiesce.compare.zones import Machine

SAME_LENGTH = 0.2  # of the longer record


@dataclass(frozen=True)
class Options:
    """What is asked for. band_Hz: ends that are None come from the recordings."""

    channels: Sequence[Wanted] = ()
    reference: Wanted | None = None
    band_Hz: tuple[float | None, float | None] = (None, None)
    machine: Machine | None = None
    has_comfort: bool = False
    limits: Sequence[Limit] = ()
    title: str = "Vibration before and after"


@dataclass(frozen=True)
class Report:
    """doubts: of the whole; each channel has its own."""

    title: str
    sources: tuple[Source, Source]
    hashes: tuple[str, str]
    settings: Settings
    channels: list[Found]
    reference: Pair | None
    verdicts: list[Verdict]
    doubts: list[str] = field(default_factory=list)

    @property
    def is_kept(self) -> bool:
        return all(one.is_kept for one in self.verdicts)

    @property
    def changed_parameters(self) -> list[tuple[str, int | None, int | None]]:
        """Name, before, after; of those that both logs have, or one."""
        before, after = (source.origin.parameters for source in self.sources)
        if not before or not after:
            return []
        return [
            (name, before.get(name), after.get(name))
            for name in dict.fromkeys([*before, *after])
            if before.get(name) != after.get(name)
        ]


def compared(before: Source, after: Source, options: Options) -> Report:
    """UsageError, one line, for whatever these recordings cannot answer."""
    hashes = sha256_of(before.file), sha256_of(after.file)
    if hashes[0] == hashes[1]:
        raise UsageError(
            f"{shown(before.file)} and {shown(after.file)} are one recording, byte for byte; name "
            "two different ones"
        )
    reference = None
    if options.reference is not None:
        reference = pair_of(before, after, options.reference, "--reference")
    taken = chosen(before, after, options.channels)
    if options.reference is not None:
        taken = _without(before, taken, options.reference)
    pairs = [pair_of(before, after, one, "--channel") for one in taken]
    all_pairs = [*pairs, *([reference] if reference else [])]
    settings = Settings(band_of(all_pairs, *options.band_Hz), options.machine, options.has_comfort)
    progress = Progress(len(pairs))
    channels = []
    for pair in pairs:
        channels.append(found(pair, reference, settings))
        progress.done(pair.name)
    used = [*taken, *([options.reference] if options.reference else [])]
    doubts = [
        *_doubts_of_sources(before, after), *_lengths(pairs),
        *_doubts_of_input(reference, settings), *left_out(before, after, used),
    ]  # fmt: skip
    return Report(
        options.title, (before, after), hashes, settings, channels, reference,
        judged(options.limits, channels), doubts,
    )  # fmt: skip


def _without(before: Source, taken: list[Wanted], reference: Wanted) -> list[Wanted]:
    own = before.known(reference.before)
    rest = [one for one in taken if before.known(one.before) != own]
    if not rest:
        raise UsageError(
            f"{reference.before} is the reference and the only channel; name another: --channel"
        )
    return rest


def _doubts_of_sources(before: Source, after: Source) -> list[str]:
    return [
        f"{side}: {line}"
        for side, source in zip(SIDES, (before, after), strict=True)
        for line in source.origin.doubts
    ]


def _lengths(pairs: Sequence[Pair]) -> list[str]:
    """Peaks of a longer record are larger, whatever the structure does."""
    longest = {side: max(getattr(pair, side).duration_s for pair in pairs) for side in SIDES}
    short, long = min(longest.values()), max(longest.values())
    if short >= (1.0 - SAME_LENGTH) * long:
        return []
    return [
        f"the recordings are {longest['before']:.4g} s and {longest['after']:.4g} s long: the peak "
        "of a longer one is larger whatever the structure does; compare RMS and typical peaks"
    ]


def _doubts_of_input(reference: Pair | None, settings: Settings) -> list[str]:
    if reference is None:
        return [
            "no reference channel: a change of the input cannot be told from one of the structure "
            "(--reference names the channel of the base or of the force's side)"
        ]
    of_samples = [f"reference, {line}" for line in reference.doubts]
    return [*of_samples, *input_doubts(reference, settings.band_Hz)]
