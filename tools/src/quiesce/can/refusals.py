"""Why a controller refuses a table (quiesce_table_verdict_t), in words, and what to do about it."""

from dataclasses import dataclass

from quiesce.can.parameters import text_of
from quiesce.can.roads import chooser_of, users_of
from quiesce.can.services import DONE, Services
from quiesce.engine.params import parameters
from quiesce.table.kinds import KINDS, LEARNT_ROAD, TRACKER, Kind


@dataclass(frozen=True)
class Verdict:
    label: str  # QUIESCE_TABLE_ in the firmware
    why: str
    what_to_do: str

    @property
    def text(self) -> str:
        return f"{self.why}; {self.what_to_do}"


MAGIC, BOARD = 2, 10
# What was learnt is refused as a whole, with whatever verdict.
LEARNT_TEXT = (
    "it was learnt by another law, with another table or another setting; use those, or let it "
    "learn anew"
)
VERDICTS = {
    0: Verdict("OK", "it is good", "nothing is to be done"),
    1: Verdict("SIZE", "it is shorter than it says, or too long", "make the file again"),
    MAGIC: Verdict(
        "MAGIC",
        "it is of a kind, or of a version of it, that the law and the tracker that run do not take",
        "'quiesce can tables' shows what they work with",
    ),
    3: Verdict("CRC", "it is damaged: its CRC-32 is not that of its words", "make the file again"),
    4: Verdict(
        "SHAPE",
        "it has more inputs, outputs, rules or points than the controller takes, or too few",
        "make it smaller, of what the law works with",
    ),
    5: Verdict(
        "CELL", "a membership is wrong: its points do not rise, or its steps do not fit",
        "compile the rules again with this version of the tools",
    ),
    6: Verdict(
        "RULE", "a rule names a set or an output that is not there",
        "compile the rules again with this version of the tools",
    ),
    7: Verdict(
        "OUTPUT", "a term of an output is out of range",
        "keep the outputs of the rules within their universe and the driver's current",
    ),
    8: Verdict(
        "FIT",
        "its inputs, outputs or units are not the law's, the board lacks a signal or a damper that "
        "it needs, or it is made for another tick rate",
        "compile rules with --controller; compare the signals with 'quiesce board show', the rate "
        "with 'quiesce can get tick_rate_Hz'",
    ),
    9: Verdict(
        "POINT",
        "one of its numbers is out of range, or its points do not rise",
        "make it again within the limits of its kind",
    ),
    BOARD: Verdict(
        "BOARD", "it is made for another board",
        "make it for the board of this controller, or load it into the controller that it is of",
    ),
}  # fmt: skip


def verdict_of(number: int) -> Verdict:
    """Also of one that is younger than this table."""
    return VERDICTS.get(number) or Verdict(
        str(number), f"verdict {number}, which these tools do not know", "update the tools"
    )


def why_refused(services: Services, number: int, kind: Kind) -> str:
    """A table of this kind, by the controller behind `services`, which is asked what it runs."""
    if kind.road == LEARNT_ROAD:
        return LEARNT_TEXT
    if number != MAGIC:
        return verdict_of(number).text
    return why_not_this_kind(kind, label_of(services, "law"), label_of(services, "tracker"))


def label_of(services: Services, name: str) -> str:
    """A parameter in effect; empty where the controller does not say."""
    one = next(one for one in parameters() if one["name"] == name)
    reply = services.ask("READ", one["index"])
    return text_of(one, reply.param_value) if reply and reply.result == DONE else ""


def why_not_this_kind(kind: Kind, law: str, tracker: str) -> str:
    """law, tracker: labels of what runs."""
    chooser, users = chooser_of(kind), users_of(kind)
    runs = tracker if chooser == "tracker" else law
    if runs not in users:
        taken = next(
            (one.name for one in KINDS.values() if one.road == kind.road and runs in users_of(one)),
            "",
        )
        return (
            f"the controller runs {chooser} {runs or 'of an unknown number'}, which takes "
            f"{taken or 'no table'}; this is {kind.name}, for {chooser} {' or '.join(users)}: "
            f"quiesce can set {chooser}={users[0]}"
        )
    if kind.road == TRACKER:
        return (
            f"the controller runs law {law}, which demands a current and so has no tracker; choose "
            "a law that demands forces with 'quiesce can set law=..'"
        )
    return f"these {kind.name} are of another version than the controller's firmware takes"
