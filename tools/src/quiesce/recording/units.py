"""Units of a column: found at the end of its name, or stated; never guessed."""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Unit:
    """SI value = scale * value + offset."""

    name: str
    scale: float
    offset: float = 0.0


def _units(**scales: float) -> dict[str, Unit]:
    return {name.lower(): Unit(name, scale) for name, scale in scales.items()}


STANDARD_GRAVITY_m_s2 = 9.80665
POUND_FORCE_N = 4.4482216152605
INCH_m = 0.0254

TIME = _units(s=1.0, ms=1e-3, us=1e-6, min=60.0)
LENGTH = _units(m=1.0, cm=1e-2, mm=1e-3, um=1e-6, **{"in": INCH_m})
VELOCITY = _units(m_s=1.0, cm_s=1e-2, mm_s=1e-3, um_s=1e-6, in_s=INCH_m)
ACCELERATION = _units(m_s2=1.0, cm_s2=1e-2, mm_s2=1e-3, g=STANDARD_GRAVITY_m_s2)
FORCE = _units(N=1.0, kN=1e3, kgf=STANDARD_GRAVITY_m_s2, lbf=POUND_FORCE_N)
CURRENT = _units(A=1.0, mA=1e-3)
VOLTAGE = _units(V=1.0, mV=1e-3)
TEMPERATURE = {  # in degrees Celsius
    "c": Unit("C", 1.0),
    "k": Unit("K", 1.0, -273.15),
    "f": Unit("F", 5.0 / 9.0, -160.0 / 9.0),
}
FREQUENCY = _units(Hz=1.0)

# What a unit may be written as, once it is in lower case and without blanks.
_SPELLINGS = {
    "sec": "s", "second": "s", "seconds": "s", "msec": "ms", "µs": "us", "μs": "us", "usec": "us",
    "µm": "um", "μm": "um", "inch": "in", "meter": "m", "metre": "m",
    "newton": "n", "amp": "a", "ampere": "a", "volt": "v",
    "°c": "c", "degc": "c", "deg_c": "c", "°f": "f", "degf": "f",
}  # fmt: skip


def normal(text: str) -> str:
    """One spelling of a unit: lower case, 'm/s^2' and 'm/s²' as 'm_s2'."""
    text = re.sub(r"\s+", "", text).lower().replace("²", "2").replace("^", "").replace("**", "")
    text = text.replace("/", "_")
    head, slash, tail = text.partition("_")
    return _SPELLINGS.get(text, _SPELLINGS.get(head, head) + slash + tail)


def names(units: dict[str, Unit]) -> str:
    return ", ".join(unit.name for unit in units.values())


def split_name(name: str, units: dict[str, Unit]) -> tuple[str, Unit | None]:
    """A column's name without its unit, and the unit; None where its end is none of `units`.

    Understood are 'x_mm', 'x mm', 'x/mm', 'x (mm)', 'x [mm]', 'v_mm/s', 'v_mm_s'.
    """
    text = name.strip()
    bracketed = re.fullmatch(r"(.*?)\s*[(\[]\s*([^()\[\]]+?)\s*[)\]]", text)
    if bracketed:
        return stem(bracketed[1]), units.get(normal(bracketed[2]))
    # The longest end wins: 'v_m_s' ends in m/s, not in s.
    for cut in [match.start() for match in re.finditer(r"[_\s/.\-]", text)]:
        unit = units.get(normal(text[cut + 1 :]))
        if cut > 0 and unit:
            return stem(text[:cut]), unit
    return stem(text), None


# Words that say nothing about what a column is.
_IDLE = {"raw", "meas", "measured", "actual", "damper", "piston"}


def stem(text: str) -> str:
    words = [word for word in re.split(r"[^a-z0-9]+", text.lower()) if word]
    return "_".join([word for word in words if word not in _IDLE] or words)
