"""Who stands at the rig: does what a step asks for, and says that it may go on."""

from typing import Protocol


class Left(Exception):
    """He leaves; the step that is under way is not done."""


class Hand(Protocol):
    """Both raise Left where he does not go on."""

    def do(self, text: str) -> None:
        """What he is to do; comes back when it is done."""

    def allow(self, text: str) -> None:
        """A hazard: comes back only when he has typed yes."""
