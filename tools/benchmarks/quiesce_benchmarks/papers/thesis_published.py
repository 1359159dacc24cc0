"""What the thesis on the RD-8040-1 prints: parameters (Tables 4.2, 4.6) and errors (4.4, 4.7, 4.12,
4.18), in its order of the currents."""

import numpy as np
from quiesce.base.paths import root
from quiesce.damper.model_file import DamperModel, read_model

CURRENTS_A = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
MIDDLE = 3  # 0.6 A: scenarios B and C
AMPLITUDE_m = 1.5e-3
FREQ_Hz = 10.0

# Errors in %, by scenario.
ERRORS_pct = {
    "modified_bouc_wen": {
        "A": (56.09, 10.34, 8.23, 8.71, 9.59, 11.22),
        "B": (46.60, 13.09, 9.96, 8.71, 9.29, 16.44),
        "C": (138.24, 21.02, 10.18, 8.71, 10.42, 20.26),
        "D": (107.49, 18.79, 17.92, 16.44, 15.01, 11.22),
    },
    "kwok_tanh": {
        "A": (6.82, 10.01, 3.50, 6.05, 3.09, 3.51),
        "B": (4722.83, 65.43, 13.04, 6.05, 5.63, 8.84),
        "C": (24.89, 35.98, 21.61, 6.05, 21.58, 54.93),
        "D": (65.36, 15.08, 5.24, 8.84, 4.85, 3.51),
    },
    "anfis9": {
        "A": (5.12, 4.11, 3.25, 3.48, 2.78, 3.67),
        "B": (77.10, 39.36, 16.67, 3.48, 16.03, 19.32),
    },
    "anfis27": {"A": (6.40, 5.36, 4.23, 4.13, 3.24, 4.10)},
}

# Table 4.6, columns by current. x_a i + x_b, alpha also of second order.
_TANH = {
    "c_a": (3078.41, 1625.78, 2035.00, 1711.07, 672.03, 363.69),
    "c_b": (1592.15, 1492.85, 1010.80, 1184.96, 1971.24, 485.64),
    "k_a": (-288040.52, 27.62, -40561.77, -63913.90, -77296.85, -98311.31),
    "k_b": (998.22, 407.80, 105.62, 232.57, 351.89, 263.79),
    "alpha_a": (820.98, -595.39, -717.86, 764.71, -1290.97, -1380.42),
    "alpha_b": (73160.81, 2729.33, 1931.06, 745.17, 2308.57, 2500.17),
    "alpha_c": (100.00, -87.63, 12.51, 97.60, -56.29, 43.34),
    "beta": (44.38, 47.39, 36.32, 31.38, 29.93, 26.88),
    "delta_a": (0.59, 0.52, 0.52, 0.55, 0.56, 0.39),
    "delta_b": (0.84, 0.93, 0.71, 0.55, 0.50, 0.49),
    "f0_a": (3.25, 22.15, 0.31, -4.17, 13.27, 0.05),
    "f0_b": (-8.24, 44.73, -18.64, 35.41, -13.35, -13.84),
}

# Table 4.2. Its gamma is the usual beta, its lambda the usual gamma, its beta the usual A.
_BOUC_WEN = {
    "c0_a": (3178.27, 2001.24, 2091.29, 2842.23, 3881.18, 3075.68),
    "c0_b": (4500.01, 4500.00, 4513.19, 5336.02, 5122.17, 4514.26),
    "k0_a": (7000.00, 6115.13, 7000.00, 6609.54, 7000.00, 6711.34),
    "k0_b": (9273.62, 14028.67, 12994.59, 30000.00, 29969.10, 29937.62),
    "alpha_a": (788.21, 894.49, 855.22, 715.38, 581.13, 520.93),
    "alpha_b": (300.29, 518.10, 478.26, 337.99, 315.20, 300.00),
    "f0_a": (552.71, 293.02, 556.88, 600.00, 491.78, 200.00),
    "f0_b": (152.13, 247.29, 250.00, 80.00, 217.39, 131.89),
    "n_a": (1.71, 2.10, 3.48, 3.50, 3.49, 3.50),
    "n_b": (1.00, 3.53, 4.00, 4.00, 3.99, 4.00),
    "gamma_a": (134000.70, 135831.05, 90776.97, 80000.00, 80105.91, 82167.09),
    "gamma_b": (350000.00, 333239.49, 100000.00, 101171.07, 100519.84, 100000.00),
    "lambda_a": (8000.00, 8000.00, 8031.41, 8021.91, 8008.42, 8025.55),
    "lambda_b": (10015.24, 10607.79, 10000.00, 10002.25, 10001.61, 10005.90),
    "beta_a": (-600000.00, -497206.08, -596085.91, -567784.27, -600000.00, -600000.00),
    "beta_b": (3000000.00, 1000000.00, 1004078.35, 1000000.00, 1000000.00, 1000000.00),
    "c1": (600000.00, 600000.00, 636136.36, 766198.09, 741164.57, 800000.00),
    "k1": (10000.00, 14068.80, 40073.32, 48977.11, 50000.00, 49758.10),
}


def file_of(name: str) -> DamperModel:
    return read_model(root() / f"sim_hil/data/dampers/rd8040_{name}.toml")


def tanh_at(column: int, current_A: float) -> DamperModel:
    """The hysteretic model of one column of Table 4.6 by its laws at a current."""
    t = {name: values[column] for name, values in _TANH.items()}
    parameters = {
        **{
            key: t[f"{name}_a"] * current_A + t[f"{name}_b"]
            for key, name in (("c_N_s_m", "c"), ("k_N_m", "k"), ("delta", "delta"), ("f0_N", "f0"))
        },
        "alpha_N": t["alpha_a"] * current_A**2 + t["alpha_b"] * current_A + t["alpha_c"],
        "beta_s_m": t["beta"],
        "x_s_m": 0.0,
    }
    return DamperModel(f"tanh, column {column}", "kwok_tanh", 1.6e-3, 0.1, parameters)


def bouc_wen_at(column: int, current_A: float) -> DamperModel:
    """The modified Bouc-Wen model of one column of Table 4.2, normalised: |z| up to 1."""
    t = {name: values[column] for name, values in _BOUC_WEN.items()}

    def law(name: str) -> float:
        return t[f"{name}_a"] * current_A + t[f"{name}_b"]

    slope, both, n = law("beta"), law("gamma") + law("lambda"), law("n")
    largest = float(np.power(slope / both, 1.0 / n))
    parameters = {
        "c0_N_s_m": law("c0"),
        "k0_N_m": law("k0"),
        "c1_N_s_m": t["c1"],
        "k1_N_m": t["k1"],
        "kw_N": law("alpha") * largest,
        "rho_1_m": slope / largest,
        "sigma": law("lambda") / both,
        "n": n,
        "f0_N": law("f0"),
    }
    return DamperModel(f"Bouc-Wen, column {column}", "modified_bouc_wen", 1.6e-3, 0.1, parameters)
