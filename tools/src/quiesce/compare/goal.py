"""What a waveform is searched for: the index, a figure, or a weighted mean of figures, each over
that of all current."""

from dataclasses import dataclass

from quiesce.base.errors import UsageError
from quiesce.compare.figures import INDEXED, OF_CONTACTS, Figures
from quiesce.compare.smooth import SMOOTH, Layout, slopes_of
from quiesce.plant.open_loop import Motion

INDEX = "index"


@dataclass(frozen=True)
class Goal:
    """Mean of the figures' ratios to those of all current, with weights above 0 that sum to 1."""

    name: str
    weights: tuple[tuple[str, float], ...]

    def require(self, has_contacts: bool) -> None:
        """UsageError where it asks for a figure that only plants with contacts have."""
        of_contacts = {name for name, _, _ in OF_CONTACTS}
        for name, _ in self.weights:
            if name in of_contacts and not has_contacts:
                raise UsageError(
                    f"--clairvoyant {self.name}: the plant has no contact below a body, and only "
                    f"those have {name}"
                )

    def value(self, figures: Figures, all_current: Figures) -> float:
        return sum(weight * figures[name] / all_current[name] for name, weight in self.weights)

    def smooth(
        self, motion: Motion, layout: Layout, all_current: Figures, sharpness: float
    ) -> tuple[float, Motion]:
        """The value, smoothed, and its slopes by the motion."""
        slopes = Motion.zeros(*motion.disp_m.shape, motion.coil_A.shape[1])
        value = 0.0
        for name, weight in self.weights:
            part = weight / all_current[name]
            value += part * slopes_of(name, motion, layout, sharpness, part, slopes)
        return value, slopes


def read_goal(text: str) -> Goal:
    """index, a figure's name, or NAME:WEIGHT,NAME:WEIGHT,... UsageError for anything else."""
    if text == INDEX:
        return Goal(INDEX, tuple((name, 1.0 / len(INDEXED)) for name in INDEXED))
    weights: dict[str, float] = {}
    for word in text.split(","):
        name, _, number = word.partition(":")
        if name not in SMOOTH:
            raise UsageError(
                f"--clairvoyant {text}: '{name}' is nothing to search for; there are: "
                f"{', '.join([INDEX, *SMOOTH])}"
            )
        weights[name] = _weight(text, number) if number else 1.0
    total = sum(weights.values())
    return Goal(text, tuple((name, weight / total) for name, weight in weights.items()))


def _weight(text: str, number: str) -> float:
    try:
        weight = float(number)
    except ValueError:
        weight = 0.0
    if not 1e-6 <= weight <= 1e6:
        raise UsageError(f"--clairvoyant {text}: a weight is a number in 1e-6 .. 1e6")
    return weight
