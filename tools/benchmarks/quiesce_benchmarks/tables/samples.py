"""Two tables of each kind for one accelerometer and one damper at 1 kHz, told apart by the largest
current that a steady vibration gets with them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from quiesce.damper.bank.table import ONE, Bank, ConstantModel, Element, bank_words
from quiesce.damper.force_map import Map, words_of_map
from quiesce.damper.inverse import VELOCITY
from quiesce.law.forms.friction import BACK, OUTWARD, FrictionSection, FrictionTable
from quiesce.law.forms.fuzzy_signals import FuzzySection, FuzzySignalsTable
from quiesce.law.forms.linear import LinearTable, Row
from quiesce.law.forms.network import (
    DEMAND,
    NetworkSection,
    NetworkTable,
    NetworkTrackTable,
    Span,
)
from quiesce.law.forms.polynomial import PolynomialSection, PolynomialTable, Term
from quiesce.law.forms.signs import SignsSection, SignsTable, combination
from quiesce.law.signal import Input, Signal, signal
from quiesce.network.layers import Dense, Layers, Output
from quiesce.rules import model
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.integers.rule_words import read_rules
from quiesce.rules.integers.table import table_words
from quiesce.table import kinds
from quiesce.table.words import crc_of, sealed
from quiesce.tune.phase_table import SETTINGS, PhaseLaw, Point
from quiesce.tune.phase_words import law_words

RATE_Hz = 1000
FIRST_mA, SECOND_mA = 400, 900
LEARNT_FIRST_mA = 1200  # a level is halved at the most
VELOCITY_IN = Input.of(signal("velocity"), 1.0)
# The tracker's stand-in: at any motion 20 N without current, and 300 N more for an ampere.
REST_N, PER_A_N = 20.0, 300.0
MOST_mA = 1500
LEAST_m_s = 1e-3


@dataclass(frozen=True)
class Sample:
    """A kind's two tables: words, and the largest current with them. before: a table that has to be
    in use first; settings: parameters, by name."""

    kind: kinds.Kind
    first: tuple[list[int], int]
    second: tuple[list[int], int]
    settings: dict[str, str]
    before: list[int] | None

    @property
    def name(self) -> str:
        return self.kind.name

    @property
    def road(self) -> str:
        return ("law", "tracker", "learnt")[self.kind.road]


def force_N(current_mA: int) -> float:
    return REST_N + 1e-3 * PER_A_N * current_mA


def one_rule(current: float, inputs: tuple[tuple[str, float, float], ...]) -> model.RuleBase:
    """The same output whatever the inputs."""
    every = model.FuzzySet("any", ((0.0, 1.0),))
    return model.RuleBase(
        "one_rule",
        tuple(model.Input(name, low, high, (every,)) for name, low, high in inputs),
        (
            model.Output(
                "current", 0.0, 2.0, (model.Singleton("it", current),), model.WEIGHTED_SUM, 0.0
            ),
        ),
        (model.Rule((model.Condition(0, 0),), (0,)),),
    )


def rules(current_mA: int) -> list[int]:
    base = one_rule(1e-3 * current_mA, (("freq", 0.0, 25.0), ("rms", 0.0, 2.0)))
    return table_words(compile_base(base, [1e-6, 1e-6], [1e-3]))


def pulses(current_mA: int) -> list[int]:
    """Without a gap: the level throughout."""
    point = (0.0, 180.0, current_mA, 0)
    points = (Point(1.0, *point), Point(50.0, *point))
    return law_words(PhaseLaw("level", "a constant", 0, dict.fromkeys(SETTINGS, points)))


def linear(current_mA: int) -> list[int]:
    """Against the motion, up to a force that takes this current."""
    row = Row(0, 10, round(1e3 * force_N(current_mA)), (1 << 20,))
    return LinearTable(RATE_Hz, (VELOCITY_IN,), (), (row,)).words()


def signs(current_mA: int) -> list[int]:
    one = combination((VELOCITY_IN,), (1.0,), LEAST_m_s)
    section = SignsSection((VELOCITY_IN,), (one,), 0, (current_mA, current_mA))
    return SignsTable((section,)).words()


def friction(current_mA: int) -> list[int]:
    limit_mN = round(1e3 * force_N(current_mA))
    return FrictionTable((FrictionSection(1 << 29, 1000, limit_mN, 100, OUTWARD | BACK),)).words()


def polynomial(current_mA: int) -> list[int]:
    section = PolynomialSection((VELOCITY_IN,), (False,), (Term(256 * current_mA, (0,)),))
    return PolynomialTable((section,)).words()


def constant_layers(current_mA: int, values: int) -> Layers:
    flat = Dense(False, ((0, *(0,) * (1 + values)),))
    return Layers((flat,), Output(0, 0, current_mA, (0,)))


def network(current_mA: int) -> list[int]:
    spans = (Span.of(signal("velocity"), -1.0, 1.0),)
    return NetworkTable(
        (NetworkSection(spans, 0, MOST_mA, constant_layers(current_mA, 1)),)
    ).words()


def rules_on_signals(current_mA: int) -> list[int]:
    base = one_rule(1e-3 * current_mA, (("velocity", -1.0, 1.0),))
    words = table_words(compile_base(base, [1.0 / VELOCITY_IN.per_unit], [1.0 / 256e3]))
    section = FuzzySection((VELOCITY_IN,), (False,), (), read_rules(words))
    return FuzzySignalsTable((section,)).words()


def damper_map(per_A_N: float = PER_A_N) -> list[int]:
    places = np.array([-1.0, -LEAST_m_s, LEAST_m_s, 1.0])
    currents_A = np.array([0.0, 1e-3 * MOST_mA])
    along = REST_N + per_A_N * currents_A
    return words_of_map(Map(VELOCITY, places, currents_A, np.outer(np.sign(places), along)))


def map_for(current_mA: int) -> list[int]:
    """With which the demand of FIRST_mA takes this current."""
    return damper_map((force_N(FIRST_mA) - REST_N) / (1e-3 * current_mA))


def bank(current_mA: int) -> list[int]:
    """The same as a saturation of the velocity, at 1 um/s."""
    most_N = REST_N + (force_N(FIRST_mA) - REST_N) * MOST_mA / current_mA
    models = tuple(
        ConstantModel(mA, 0, 0, (round(1e3 * force),))
        for mA, force in ((0, REST_N), (MOST_mA, most_N))
    )
    return bank_words([Bank(RATE_Hz, 0, 0, 0, (Element(False, ONE, 1),), models)])


def inverse_network(current_mA: int) -> list[int]:
    spans = (
        Span.of(Signal(DEMAND, 0), -1500.0, 1500.0),
        Span.of(signal("stroke velocity", 0), -0.5, 0.5),
    )
    section = NetworkSection(spans, 0, MOST_mA, constant_layers(current_mA, 2), 1000)
    return NetworkTrackTable((section,)).words()


# firmware/law/phase/adapt_store.h
ADAPT_MAGIC, ADAPT_POINTS, BALANCED = 0x31444151, 64, 1
ALL_LEVEL = 1 << 15


def learnt(of: list[int], current_mA: int, level_mA: int) -> list[int]:
    """What law `phase` has learnt about pulses `of` of one level: a lower one, everywhere."""
    trim = (current_mA - level_mA) * ALL_LEVEL // level_mA
    owned = [of[1], BALANCED, *(0, trim % (1 << 16)) * ADAPT_POINTS]
    return sealed(kinds.LEARNT.magic, [ADAPT_MAGIC, crc_of(owned), *owned])


def all_samples() -> tuple[Sample, ...]:
    """In the order of the kinds."""
    forces = {"law": "linear"}
    demand = linear(FIRST_mA)
    of_level = pulses(MOST_mA)
    return (
        two(kinds.RULES, rules, {"law": "fuzzy"}),
        two(kinds.PULSES, pulses, {"law": "phase"}),
        two(kinds.LINEAR, linear, forces, damper_map()),
        two(kinds.SIGNS, signs, {"law": "signs"}),
        two(kinds.FRICTION, friction, {"law": "friction"}, damper_map()),
        two(kinds.POLYNOMIAL, polynomial, {"law": "polynomial"}),
        two(kinds.NETWORK, network, {"law": "network"}),
        two(kinds.RULES_ON_SIGNALS, rules_on_signals, {"law": "fuzzy_signals"}),
        two(kinds.MAP, map_for, forces, demand),
        two(kinds.BANK, bank, {**forces, "tracker": "bank"}, demand),
        two(kinds.INVERSE_NETWORK, inverse_network, {**forces, "tracker": "network"}, demand),
        two(
            kinds.LEARNT,
            lambda current_mA: learnt(of_level, current_mA, MOST_mA),
            {"law": "phase", "adapt": "frozen"},
            of_level,
        ),
    )


def two(
    kind: kinds.Kind,
    make: Callable[[int], list[int]],
    settings: dict[str, str],
    before: list[int] | None = None,
) -> Sample:
    first_mA = LEARNT_FIRST_mA if kind is kinds.LEARNT else FIRST_mA
    return Sample(kind, (make(first_mA), first_mA), (make(SECOND_mA), SECOND_mA), settings, before)
