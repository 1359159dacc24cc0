"""A table in words: signals, gains in SI units, poles, limits, patterns."""

import math

import numpy as np

from quiesce.base.table import format_table
from quiesce.law.describe_network import described_networks
from quiesce.law.describe_rules import described_rules
from quiesce.law.forms.friction import BACK, OUTWARD, FrictionTable
from quiesce.law.forms.fuzzy_signals import FuzzySignalsTable
from quiesce.law.forms.linear import LinearTable
from quiesce.law.forms.network import NetworkTable, NetworkTrackTable
from quiesce.law.forms.polynomial import PolynomialTable
from quiesce.law.forms.signs import Combination, SignsSection, SignsTable
from quiesce.law.signal import Input
from quiesce.law.tables import Table


def described(table: Table) -> str:
    if isinstance(table, NetworkTrackTable):
        head = f"tracker {table.law}; dampers {_dampers(table)}"
        return "\n\n".join([head, *described_networks(table)])
    head = f"law {table.law}, demands {table.demands}; dampers {_dampers(table)}"
    if isinstance(table, LinearTable):
        return "\n\n".join([head, *_linear(table)])
    if isinstance(table, SignsTable):
        parts = [_signs(i, section) for i, section in enumerate(table.sections)]
    elif isinstance(table, FrictionTable):
        parts = [_friction(table)]
    elif isinstance(table, FuzzySignalsTable):
        parts = described_rules(table)
    elif isinstance(table, NetworkTable):
        parts = described_networks(table)
    else:
        parts = [_polynomial(table)]
    return "\n\n".join([head, *parts])


def _dampers(table: Table) -> str:
    return ", ".join(str(i + 1) for i in sorted(table.dampers()))


def _limit(one: Input) -> str:
    quantity = one.signal.quantity
    return f"{one.limit / quantity.per_unit:.4g} {quantity.unit}"


def _linear(table: LinearTable) -> list[str]:
    a, b, c, d = table.matrices()
    scale = np.array([one.per_unit for one in table.inputs])
    direct = 1e-3 * d * scale
    constant = direct
    if len(a):
        constant = direct + 1e-3 * c @ np.linalg.solve(np.eye(len(a)) - a, b * scale)
    head = ["signal", "limit"]
    for i, row in enumerate(table.rows):
        head += [f"row {i + 1}: damper {row.damper + 1}", "at once"]
    rows = [
        [one.signal.name, _limit(one), *_pairs(constant[:, k], direct[:, k])]
        for k, one in enumerate(table.inputs)
    ]
    limits = ["limit", "", *(x for row in table.rows for x in (f"{1e-3 * row.limit_mN:.4g} N", ""))]
    parts = [
        f"made for {table.rate_Hz} ticks a second; N for 1 in the signal's SI unit that lasts, and "
        "at once:\n" + format_table(head, [*rows, limits], (0,))
    ]
    return parts + ([_poles(a, table.rate_Hz)] if len(a) else [])


def _pairs(constant: np.ndarray, direct: np.ndarray) -> list[str]:
    return [f"{x:.5g}" for pair in zip(constant, direct, strict=True) for x in pair]


def _poles(a: np.ndarray, rate_Hz: int) -> str:
    rows = []
    for pole in np.linalg.eigvals(a):
        if pole.imag < 0 or pole == 0:
            continue
        rate = np.log(pole) * rate_Hz
        size = abs(rate)
        rows.append((size / (2 * math.pi), -rate.real / size))
    return format_table(["pole||.5g Hz", "damping ratio||.4g"], sorted(rows), ())


def _sum(section: SignsSection, one: Combination) -> str:
    factors = np.array(one.coefficients) * np.array([x.per_unit for x in section.inputs])
    size = np.abs(factors).max()
    terms = [
        f"{factor / size:+.4g} {x.signal.name}"
        for factor, x in zip(factors, section.inputs, strict=True)
        if factor
    ]
    return f"{' '.join(terms)}; band {one.band * 2.0**one.shift / size:.4g}"


def _signs(damper: int, section: SignsSection) -> str:
    count = len(section.combinations)
    lines = [f"damper {damper + 1}"]
    lines += [f"  sign {j + 1}: {_sum(section, one)}" for j, one in enumerate(section.combinations)]
    rows = [
        ("".join("+" if number >> j & 1 else "-" for j in range(count)), mA / 1e3)
        for number, mA in enumerate(section.currents_mA)
    ]
    rows.append(("not known, at rest", section.idle_mA / 1e3))
    return "\n".join([*lines, format_table(["signs", "current||g A"], rows)])


def _friction(table: FrictionTable) -> str:
    rows = [
        (
            i, one.gain_N_m, 1e-6 * one.least_peak_nm, 1e-3 * one.limit_mN, 1e-3 * one.band_um_s,
            {OUTWARD: "outward", BACK: "back"}.get(one.ways, "both"),
        )
        for i, one in enumerate(table.sections, start=1)
    ]  # fmt: skip
    head = ["damper", "gain|| N/m", "least peak||g mm", "limit||g N", "band||g mm/s", "ways"]
    return format_table(head, rows, (0, 5))


def _polynomial(table: PolynomialTable) -> str:
    rows = []
    for i, section in enumerate(table.sections, start=1):
        names = [
            f"|{one.signal.name}|" if flag else one.signal.name
            for one, flag in zip(section.inputs, section.is_magnitude, strict=True)
        ]
        for one in section.terms:
            scale = np.prod(
                [
                    (x.per_unit / 2.0**30) ** p
                    for x, p in zip(section.inputs, one.powers, strict=True)
                ]
            )
            factors = [f"{n}^{p}" for n, p in zip(names, one.powers, strict=True) if p]
            rows.append((i, 1e-3 * one.coefficient / 256 * scale, " ".join(factors) or "1"))
    return format_table(["damper", "factor, SI units||.5g A", "of"], rows, (0, 2))
