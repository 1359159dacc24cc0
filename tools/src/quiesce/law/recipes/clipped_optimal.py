"""Linear quadratic forces of an estimated state, clipped: Dyke, Spencer, Sain and Carlson 1996."""

from quiesce.law.block import Compiled, compile_system
from quiesce.law.design import Noise, Weights, lqg
from quiesce.law.recipe import Recipe, Setting
from quiesce.law.recipes.common import LIMIT_N
from quiesce.law.rig import LawRig


def make(rig: LawRig, values: dict[str, float]) -> Compiled:
    weights = Weights(
        values["displacement_1_m2"], values["drift_1_m2"], values["accel_s4_m2"],
        values["force_1_N2"], values["last_share"],
    )  # fmt: skip
    noise = Noise(values["ground_m_s2"], values["accel_noise_m_s2"])
    system = lqg(rig.structure(), weights, noise)
    inputs = [rig.input("acceleration", i) for i in range(len(rig.bodies))]
    inputs += [rig.input("force", i) for i in range(len(rig.dampers))]
    rows = [(i, values["limit_N"]) for i in range(len(rig.dampers))]
    return compile_system(system, inputs, rows, rig.rate_Hz)


RECIPE = Recipe(
    "clipped_optimal",
    "F = K z of a Kalman filter that is fed accelerations and measured forces",
    "review, eq 27 and its LQG text; Dyke, Spencer, Sain and Carlson 1996",
    "compare",
    (
        Setting(
            "displacement_1_m2",
            0.0,
            0.0,
            1e12,
            "weight of each body's squared displacement",
            (1, 1e8),
        ),
        Setting("drift_1_m2", 0.0, 0.0, 1e12, "weight of each damper's squared stroke", (1, 1e8)),
        Setting(
            "accel_s4_m2",
            1.0,
            0.0,
            1e12,
            "weight of each body's squared acceleration",
            is_tuned=False,
        ),
        Setting(
            "force_1_N2", 1e-7, 1e-18, 1e6, "weight of each damper's squared force", (1e-16, 1e-6)
        ),
        Setting("last_share", 1.0, 0.0, 1.0, "0: all bodies weigh alike, 1: the last one only"),
        Setting(
            "ground_m_s2",
            1.0,
            1e-6,
            1e6,
            "density of the ground's motion, over a root of Hz",
            is_tuned=False,
        ),
        Setting(
            "accel_noise_m_s2", 0.141, 1e-6, 1e6, "of the accelerometers, likewise", (0.01, 10)
        ),
        LIMIT_N,
    ),
    make,
    equation="F = K z, z' = A z + B F_measured + L (y - C z - D F_measured), y the accelerations; "
    "K and L from Riccati equations",
    errata="The decision is right as printed; the text keeps the voltage where the forces are "
    "equal, the formula's step takes it away: here the last decision stands within 1 %. "
    "Nothing says which way the force counts, and the wrong way is passive-off without a "
    "word.",
    when="A structure whose matrices are known, with an accelerometer a floor and a force "
    "sensor. Tracker compare is the published one, proportional rattles less.",
)
