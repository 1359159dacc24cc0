"""The published test rig of the RD-1005-3: its excitations, played on published models of the
damper, and what its sensors make of them.

5 mm between 1 and 2.5 Hz, up to 1.5 A, a row every 2 ms. Load cell of 500 kgf (4.9 kN), of which
0.1 % is noise here; displacement to 2 um, in steps of 1 um. The source states no noise.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from quiesce.base.paths import root
from quiesce.damper import sines_and_chirps
from quiesce.damper.data.condition import Settings, condition_all
from quiesce.damper.data.read import RawTest
from quiesce.damper.data.record import Record
from quiesce.damper.learned.temperature import ThermalFactors
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.damper.plan import Damper, Plan, Test, excitation
from quiesce.damper.simulate import simulator

from quiesce_benchmarks.seeds import generator

DAMPER = Damper(
    stroke_m=0.0125, max_force_N=2000.0, max_current_A=1.5, max_speed_m_s=0.1, rig_max_Hz=2.5,
    mass_kg=0.8,
)  # fmt: skip
FORCE_NOISE_N = 5.0
DISP_NOISE_m = 2e-6
DISP_STEP_m = 1e-6
# Run-in and run-out, before and after what is recorded: at rest the sign of the displacement, of
# which one of the models is made, is that of the noise.
RUN_s = 1.0
# Steps of the simulated damper in a row of the recording.
_FINE = 4


def damper_file(name: str) -> Path:
    return root() / f"sim_hil/data/dampers/{name}.toml"


@dataclass(frozen=True)
class Rig:
    """What is clamped in, and how warm it is."""

    name: str  # of a published damper file
    temperature_C: float | None = None  # None: that of the publication

    def damper(self) -> DamperModel:
        one = read_model(damper_file(self.name))
        return one if self.temperature_C is None else warmed(one, self.temperature_C)


def warmed(one: DamperModel, temperature_C: float) -> DamperModel:
    """Kwok's model at another temperature: dashpot and hysteresis have factors of their own, the
    gas spring none."""
    factors, at = ThermalFactors(), np.array(temperature_C)
    by_name = {
        "c_N_s_m": float(factors.viscous(at)),
        "alpha_N": float(factors.yielding(at)),
    }
    if one.model != "kwok_tanh":
        raise ValueError(f"{one.model} has no factors of temperature")
    changed = {
        name: (factor * np.asarray(one.parameters[name])).tolist()
        for name, factor in by_name.items()
    }
    return replace(one, parameters={**one.parameters, **changed})


def protocol() -> Plan:
    return sines_and_chirps.make_plan(DAMPER)


def test_of(kind: str, current_A: float, freq_Hz: float | None = None) -> Test:
    """Of the protocol."""
    return next(
        one
        for one in protocol().tests
        if one.kind == kind and one.current_A == current_A and freq_Hz in (None, one.freq_Hz)
    )


def recorded(rig: Rig, test: Test, seed: int, duration_s: float | None = None) -> Record:
    """As `quiesce identify --keep-offset` reads a recording of it: the rig knows its mid-stroke.
    At full amplitude throughout. duration_s: of a shorter test."""
    plan = protocol()
    plan = replace(plan, rate_Hz=_FINE * plan.rate_Hz)
    moving_s = test.duration_s if duration_s is None else duration_s
    played = excitation(plan, replace(test, duration_s=moving_s + 2.0 * RUN_s))
    velocity = np.gradient(played.disp_m, played.time_s)
    accel = np.gradient(velocity, played.time_s)
    zero = np.zeros(len(velocity))
    fine = Record(
        test.name, plan.rate_Hz, played.time_s, played.disp_m, velocity, accel, zero,
        played.current_A, "A",
    )  # fmt: skip
    force_N = simulator(rig.damper())(fine)[::_FINE]
    rng = generator(seed, rig.name, rig.temperature_C, test.name)
    disp_m = played.disp_m[::_FINE] + DISP_NOISE_m * rng.standard_normal(len(force_N))
    measured = {
        "displacement": DISP_STEP_m * np.round(disp_m / DISP_STEP_m),
        "force": force_N + FORCE_NOISE_N * rng.standard_normal(len(force_N)),
        "current": played.current_A[::_FINE],
    }
    period_s = _FINE / plan.rate_Hz
    raw = RawTest(test.name, test.name, period_s, 0.0, played.time_s[::_FINE], measured, 0.0)
    record = condition_all([raw], Settings(keep_offset=True))[0][0]
    run = round(RUN_s * record.rate_Hz)
    return record.rows(run, len(record) - run)
