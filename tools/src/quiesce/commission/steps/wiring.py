"""Is everything connected, and the right way round? A small current, for a moment."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.paths import shown
from quiesce.can.parameters import name_of, settings_of, text_of
from quiesce.commission.lag import CURRENT, IS_MEASURED, measured_lag_s
from quiesce.commission.samples import take
from quiesce.commission.site import heard
from quiesce.commission.work import Work
from quiesce.engine.params import parameters
from quiesce.tune.law import lag_ms

NAME = "wiring"
TITLE = "wiring and polarity"
BEFORE = "parameters_before.json"
TRIAL_PART = 0.2  # of the largest current
LEAST_ERROR_mA = 10
REST_S, TRIAL_S = 1.0, 1.0
FELT = 3.0  # times as much as at rest
NEAR = 0.1  # of the current
# What the trial takes from the controller for a moment.
LENT = ("law", "constant_current_mA", "unlock_current_mA")
VERSION = ("version_major", "version_minor", "version_patch")


def run(work: Work) -> dict[str, Any]:
    rig = work.site.rig
    version = ".".join(str(rig.read(f"identification/{part}")) for part in VERSION)
    before = kept_parameters(work)
    fault = rig.read("status/fault")
    if fault != "NONE":
        raise BenchFailure(f"the controller is in fault {fault}; docs/reference/faults.md")
    sensor = sensed(work)
    limit_mA = work.site.limit_mA
    trial_mA = max(1, round(TRIAL_PART * limit_mA))
    work.give(limits(limit_mA, trial_mA, int(before["safe_current_mA"])))
    work.tell(f"{1e-3 * trial_mA:g} A for a moment")
    try:
        flows = driven(work, trial_mA)
    except BaseException:  # Ctrl-C, too
        try:
            work.give(lent(before, limit_mA))
        except BenchFailure as error:
            work.tell(f"law=constant and {trial_mA} mA stay in the controller: {error}")
        raise
    work.give(lent(before, limit_mA) | lag_setting(flows["lag_s"]))
    return {"version": version, **sensor, "trial_mA": trial_mA, **flows}


def lent(before: dict[str, str], limit_mA: int) -> dict[str, int | str]:
    """What the trial took, as it was before; no current is above the limit."""
    return {
        name: before[name] if name == "law" else min(int(before[name]), limit_mA) for name in LENT
    }


def lag_setting(lag_s: float | None) -> dict[str, int | str]:
    """For the guard, which compares what flows with what the coil lets flow."""
    return {} if lag_s is None else {"current_lag_ms": lag_ms(lag_s)}


def kept_parameters(work: Work) -> dict[str, str]:
    """As the controller had them when the folder was begun: what it has when a trial is done again
    may be what that left. UsageError where the folder's file of them is not whole."""
    file = work.path / BEFORE
    if not file.is_file():
        keep_parameters(work, file)
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
        settings_of([f"{name}={said[name]}" for name in (*LENT, "safe_current_mA")])
    except (OSError, ValueError, RecursionError, KeyError, TypeError, UsageError) as error:
        raise UsageError(
            f"{shown(file)}: not whole: {one_line(error)}; without that file its place is taken by "
            "what the controller has now"
        )
    return {name: str(one) for name, one in said.items()}


def keep_parameters(work: Work, file: Path) -> None:
    """For who wants to go back."""
    values = work.site.rig.tables().services.read_all()
    known = dict(enumerate(parameters()))
    said = {
        name_of(index): text_of(known[index], value) if index in known else str(value)
        for index, value in enumerate(values)
    }
    file.write_text(json.dumps(said, indent=1) + "\n", encoding="utf-8")


def sensed(work: Work) -> dict[str, Any]:
    """The accelerometer at rest, and that it feels the structure. BenchFailure where it does
    not."""
    site = work.site
    site.shake(work.trial_Hz, 0.0)
    site.settle(REST_S)
    rest = take(site, REST_S)
    full = int(site.rig.read("parameters/accel_full_scale_counts"))
    if np.abs(rest.counts).max() >= full:
        raise BenchFailure("the accelerometer is at its full scale at rest: is it connected?")
    if rest.noise == 0.0:
        raise BenchFailure("the accelerometer's samples never change: is it connected?")
    site.shake(work.trial_Hz, work.drive_V)
    site.settle(REST_S)
    shaken = take(site, REST_S)
    site.shake(work.trial_Hz, 0.0)
    ratio = shaken.noise / rest.noise
    if ratio < FELT:
        raise BenchFailure(
            f"shaken at {work.trial_Hz:g} Hz the accelerometer reads {ratio:.1f} times as much as "
            f"at rest: is it on the structure, is --drive {work.drive_V:g} V enough?"
        )
    return {"noise_counts": rest.noise, "rest_counts": rest.mean, "shaken_ratio": ratio}


def limits(limit_mA: int, trial_mA: int, safe_mA: int) -> dict[str, int | str]:
    """What no law may ask for more than, and the trial."""
    error_mA = next(one["default"] for one in parameters() if one["name"] == "current_error_mA")
    return {
        "law": "constant",
        "max_current_mA": limit_mA,
        "constant_current_mA": trial_mA,
        "unlock_current_mA": trial_mA,
        "safe_current_mA": min(safe_mA, limit_mA),
        "current_error_mA": max(LEAST_ERROR_mA, min(error_mA, limit_mA // 2)),
    }


def driven(work: Work, trial_mA: int) -> dict[str, Any]:
    """What is asked for, and what the driver measures where it does. BenchFailure where that is
    not the trial."""
    site = work.site
    with site.armed("a trial of the coil"):
        site.settle(TRIAL_S)
        asked_mA = heard(site, ["current_demand/current_cmd_mA"], TRIAL_S)
        measured = measured_mA(work)
        demand_mA = float(np.median(asked_mA["current_demand/current_cmd_mA"]))
        require_trial(trial_mA, demand_mA, measured)
        lag_s = measured_lag_s(site, trial_mA) if measured is not None else None
    return {"demand_mA": demand_mA, "measured_mA": measured, "lag_s": lag_s}


def require_trial(trial_mA: int, demand_mA: float, measured: float | None) -> None:
    """BenchFailure where that is not the trial: no more current then."""
    if abs(demand_mA - trial_mA) > NEAR * trial_mA:
        raise BenchFailure(f"{trial_mA} mA were wanted, the controller asks for {demand_mA:g} mA")
    if measured is not None and abs(measured - trial_mA) > NEAR * trial_mA:
        way = "the wrong way round" if abs(measured + trial_mA) <= NEAR * trial_mA else "not that"
        raise BenchFailure(f"{trial_mA} mA were wanted, {measured:g} mA flow: {way}")


def measured_mA(work: Work) -> float | None:
    """None where nobody measures it."""
    work.site.rig.stream_raw(2)
    found = work.site.rig.capture((IS_MEASURED, CURRENT), 0.5)
    is_measured, current_mA = (
        np.asarray(found[name].values, float) for name in (IS_MEASURED, CURRENT)
    )
    if not len(is_measured) or not is_measured.any():
        return None
    return float(np.median(current_mA[is_measured > 0.0]))


def line(result: dict[str, Any]) -> str:
    flows = result["measured_mA"]
    current = f"{flows:g} mA flow" if flows is not None else "nobody measures what flows"
    if (lag_s := result.get("lag_s")) is not None:
        current += f", {1e3 * lag_s:.1f} ms behind"
    return (
        f"firmware {result['version']}; noise {result['noise_counts']:.1f} counts, shaken "
        f"{result['shaken_ratio']:.0f} times that; {result['demand_mA']:g} mA asked for, {current}"
    )
