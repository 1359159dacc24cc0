"""Laws to compare, from words: NAME[:key=value,...]."""

from dataclasses import dataclass, replace
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.nearest import listed
from quiesce.engine.bench import setting_options
from quiesce.engine.laws import labels
from quiesce.engine.params import parameters

FILES = {
    "table": "--law-table",
    "map": "--force-map",
    "rules": "--rules",
    "pulses": "--pulses",
}
LABEL = "as"


@dataclass(frozen=True)
class ComparedLaw:
    """label: in tables. options: of the bench, files of tables among them."""

    label: str
    law: str
    options: tuple[str, ...] = ()


def constant(current_mA: int, label: str) -> ComparedLaw:
    """The board's ceiling, not parameter max_current_mA, is what bounds it."""
    usual_mA = next(one["default"] for one in parameters() if one["name"] == "max_current_mA")
    most_mA = max(current_mA, usual_mA)
    settings = (f"max_current_mA={most_mA}", f"constant_current_mA={current_mA}")
    return ComparedLaw(label, "constant", tuple(setting_options(settings)))


def read_law(text: str) -> ComparedLaw:
    """UsageError where the words do not name a law, or a file is not there."""
    name, _, rest = text.partition(":")
    if name not in labels():
        raise UsageError(f"--law {text}: no law '{name}'; {listed(name, labels())}")
    found = ComparedLaw(text if rest else name, name)
    for word in filter(None, rest.split(",")):
        key, equals, value = word.partition("=")
        if not equals or not value:
            raise UsageError(f"--law {text}: expected key=value, found '{word}'")
        found = _with(found, text, key, value)
    return found


def _with(law: ComparedLaw, text: str, key: str, value: str) -> ComparedLaw:
    if key == LABEL:
        return replace(law, label=value)
    if key in FILES:
        if not Path(value).is_file():
            raise UsageError(f"--law {text}: there is no file {value}")
        return replace(law, options=(*law.options, FILES[key], value))
    return replace(law, options=(*law.options, "--set", f"{key}={value}"))


def require_labels(labels: list[str]) -> None:
    """UsageError where two are the same."""
    for name in labels:
        if labels.count(name) > 1:
            raise UsageError(
                f"--law, --recipe: two are called '{name}'; give one another name, :{LABEL}=NAME"
            )
