"""Where a search looks for a setting: what the recipe says, else what the rig's sensors reach."""

from quiesce.law.recipe import Setting
from quiesce.law.rig import LawRig

Range = tuple[float, float]  # low is high: not searched

# A gain is what is demanded over what is seen.
GAIN_RATIOS = (1 / 30, 30.0)
USUAL_SHARE = 0.3  # of a sensor's range: where a gain of either sign demands all that there is
SIGNAL_SHARES = (0.005, 1.0)
SMALL_SHARES = (1e-4, 0.03)  # of what is to stay below the motion
SMALL = ("band_", "least_")
CEILING_SHARES = {"on_A": (0.25, 1.0), "off_A": (0.0, 0.5)}
TRACKER_RATIOS = (1 / 15, 60.0)
DEFAULT_RATIO = 100.0  # around a default of which nothing else is known

# Ends of names: numerator, denominator, its power.
GAINS = {
    "_N_s2_m": ("force", "acceleration", 1), "_N_s_m": ("force", "stroke velocity", 1),
    "_N_m": ("force", "stroke", 1),
    "_A_s3_m3": ("current", "stroke velocity", 3), "_A_s2_m2": ("current", "stroke velocity", 2),
    "_A_s_m": ("current", "stroke velocity", 1), "_A_m3": ("current", "stroke", 3),
    "_A_m2": ("current", "stroke", 2), "_A_m": ("current", "stroke", 1),
}  # fmt: skip
SIGNALS = {"_m_s2": "acceleration", "_m_s": "stroke velocity", "_m": "stroke", "_N": "force"}
CURRENT = "_A"


def range_of(setting: Setting, rig: LawRig) -> Range:
    """Inside of what the recipe allows."""
    low, high = _wanted(setting, rig)
    low, high = max(low, setting.low), min(high, setting.high)
    return (low, high) if low < high else (setting.default, setting.default)


def tracker_range(rig: LawRig) -> Range | None:
    """mA/kN of a proportional tracker, around all current for the force that its sensor reaches;
    None without one."""
    force_N = _reach(rig, "force")
    if force_N is None:
        return None
    size = 1e6 * _ceiling_A(rig) / force_N
    return TRACKER_RATIOS[0] * size, TRACKER_RATIOS[1] * size


def _wanted(one: Setting, rig: LawRig) -> Range:
    if not one.is_tuned:
        return one.default, one.default
    if one.search is not None:
        return one.search
    return _of_rig(one, rig) or _of_default(one)


def _of_rig(one: Setting, rig: LawRig) -> Range | None:
    """By the unit that its name ends in; None where the board measures no such quantity."""
    for end, (top, bottom, power) in GAINS.items():
        if one.name.endswith(end):
            return _of_gain(one, _reach(rig, top), _reach(rig, bottom), power)
    if one.name.endswith(CURRENT):
        low, high = CEILING_SHARES.get(one.name, (-1.0 if one.low < 0 else 0.0, 1.0))
        return low * _ceiling_A(rig), high * _ceiling_A(rig)
    for end, quantity in SIGNALS.items():
        if one.name.endswith(end):
            size = _reach(rig, quantity)
            low, high = SMALL_SHARES if one.name.startswith(SMALL) else SIGNAL_SHARES
            return None if size is None else (low * size, high * size)
    return None


def _of_gain(one: Setting, top: float | None, bottom: float | None, power: int) -> Range | None:
    if top is None or bottom is None:
        return None
    if one.low < 0:
        most = top / (USUAL_SHARE * bottom) ** power
        return -most, most
    size = top / bottom**power
    return GAIN_RATIOS[0] * size, GAIN_RATIOS[1] * size


def _of_default(one: Setting) -> Range:
    """All that is allowed where that is not much; else around its default, and none around 0."""
    if one.high - one.low <= DEFAULT_RATIO * abs(one.default):
        return one.low, one.high
    if one.default > 0:
        return one.default / DEFAULT_RATIO, one.default * DEFAULT_RATIO
    return one.default, one.default


def _ceiling_A(rig: LawRig) -> float:
    return 1e-3 * max(damper.ceiling_mA for damper in rig.dampers)


def _reach(rig: LawRig, quantity: str) -> float | None:
    """In its SI unit, the largest of the board's sensors of that quantity."""
    if quantity == "current":
        return _ceiling_A(rig)
    found = [x for name, x in rig.ranges.items() if name.startswith(f"{quantity} of ")]
    return max(found, default=None)
