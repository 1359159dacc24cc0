"""The largest table of each kind that a controller of one accelerometer and one damper takes,
within so many words."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from quiesce.damper.bank.table import ONE, Bank, ConstantModel, Element, bank_words
from quiesce.damper.force_map import Map, words_of_map
from quiesce.damper.inverse import VELOCITY
from quiesce.law.forms.fuzzy_signals import FuzzySection, FuzzySignalsTable, Slope
from quiesce.law.forms.linear import LinearTable, Row, State
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
from quiesce.tune.phase_table import MOST_POINTS, SETTINGS, PhaseLaw, Point
from quiesce.tune.phase_words import law_words

from quiesce_benchmarks.tables import samples
from quiesce_benchmarks.tables.samples import REST_N, MOST_mA, RATE_Hz, Sample

SEED = 20
QUANTITIES = ("velocity", "acceleration", "stroke", "stroke velocity")
VELOCITY_IN = samples.VELOCITY_IN


def set_names(count: int) -> tuple[str, ...]:
    return tuple(f"s{i}" for i in range(count))


def grid_sets(low: float, high: float) -> tuple[model.FuzzySet, ...]:
    """Seven triangles."""
    at = np.linspace(low, high, 7)
    step = at[1] - at[0]
    return tuple(
        model.FuzzySet(name, ((x - step, 0.0), (x, 1.0), (x + step, 0.0)))
        for name, x in zip(set_names(7), at, strict=True)
    )


def drawn_base(
    ranges: Sequence[tuple[float, float]], outputs: int, rules: int, seed: int = SEED
) -> model.RuleBase:
    """Rules of chance over all inputs, with weights."""
    random = np.random.default_rng(seed)
    inputs = tuple(
        model.Input(f"x{i}", low, high, grid_sets(low, high))
        for i, (low, high) in enumerate(ranges)
    )
    terms = tuple(model.Singleton(f"t{i}", value) for i, value in enumerate(np.linspace(0, 1, 64)))
    out = tuple(
        model.Output(f"y{i}", 0.0, 1.0, terms, model.WEIGHTED_SUM, 0.0) for i in range(outputs)
    )
    drawn = tuple(
        model.Rule(
            tuple(model.Condition(i, int(random.integers(7))) for i in range(len(inputs))),
            tuple(int(random.integers(64)) for _ in range(outputs)),
            weight=float(random.integers(1, 17)) / 16.0,
        )
        for _ in range(rules)
    )
    return model.RuleBase("drawn", inputs, out, drawn)


def fitted(make: Callable[[int], list[int]], most_words: int) -> list[int]:
    """With as many parts as the words hold: each more takes as much as the one before."""
    low, high = len(make(20)), len(make(21))
    return make(min(model.MAX_RULES, 20 + (most_words - low) // (high - low)))


def rules(most_words: int, seed: int = SEED) -> list[int]:
    def make(count: int) -> list[int]:
        base = drawn_base(((0.0, 25.0), (0.0, 2.0)), 1, count, seed)
        return table_words(compile_base(base, [1e-6, 1e-6], [1e-3]))

    return fitted(make, most_words)


def rules_on_signals(most_words: int) -> list[int]:
    inputs = tuple(Input.of(signal(name), 1.0) for name in QUANTITIES)
    slopes = tuple(Slope(i, 40) for i in range(3))

    def make(count: int) -> list[int]:
        base = drawn_base([(-1.0, 1.0)] * 4, 4, count)
        lsbs = [1.0 / one.per_unit for one in inputs]
        words = table_words(compile_base(base, lsbs, [1.0 / 256e3] * 4))
        section = FuzzySection(inputs, (False,) * 4, slopes, read_rules(words))
        return FuzzySignalsTable((section,)).words()

    return fitted(make, most_words)


def pulses(most_words: int) -> list[int]:
    points = tuple(
        Point(freq, 40.0, 60.0, MOST_mA, 100, 0.5, 1.0, 10.0)
        for freq in np.linspace(1.0, 60.0, MOST_POINTS)
    )
    return law_words(PhaseLaw("most", "all points", 0, dict.fromkeys(SETTINGS, points)))


def linear(most_words: int) -> list[int]:
    inputs = tuple(Input.of(signal(QUANTITIES[i % 4]), 1.0) for i in range(12))
    states = tuple(
        State(40, tuple(-(1 << 20) if i == k else 1 for k in range(24))) for i in range(12)
    )
    rows = (Row(0, 10, 100_000, (1 << 18,) * 24),) * 8
    return LinearTable(RATE_Hz, inputs, states, rows).words()


def signs(most_words: int) -> list[int]:
    inputs = (VELOCITY_IN,) * 6
    combinations = (combination(inputs, (1.0,) * 6, 1e-3),) * 4
    return SignsTable((SignsSection(inputs, combinations, 0, (MOST_mA,) * 16),)).words()


def polynomial(most_words: int) -> list[int]:
    inputs = (VELOCITY_IN,) * 4
    terms = (Term(1 << 16, (3, 3, 3, 3)),) * 16
    return PolynomialTable((PolynomialSection(inputs, (True,) * 4, terms),)).words()


def dense_layers(values: int) -> Layers:
    """As wide as the work that a controller allows."""
    first = Dense(True, ((20, 0, *(1 << 18,) * values),) * 8)
    second = Dense(True, ((20, 0, *(1 << 18,) * 8),) * 10)
    return Layers((first, second), Output(0, 10, 1 << 10, (1 << 10,) * 10))


def network(most_words: int) -> list[int]:
    spans = tuple(Span.of(signal(QUANTITIES[i % 4]), -1.0, 1.0) for i in range(8))
    return NetworkTable((NetworkSection(spans, 1, MOST_mA, dense_layers(16), 0, RATE_Hz),)).words()


def damper_map(most_words: int) -> list[int]:
    """32 places, 16 currents."""
    half = np.geomspace(1e-3, 1.0, 16)
    places = np.concatenate([-half[::-1], half])
    currents_A = np.linspace(0.0, 1e-3 * MOST_mA, 16)
    along = REST_N + 300.0 * currents_A + 50.0 * np.abs(places)[:, None]
    return words_of_map(Map(VELOCITY, places, currents_A, np.sign(places)[:, None] * along))


def bank(most_words: int) -> list[int]:
    elements = (Element(False, ONE // 8, 1000),) * 8
    models = tuple(ConstantModel(200 * k, 0, 1, (100 + k,) * 8) for k in range(8))
    return bank_words([Bank(RATE_Hz, 4, 0, 0, elements, models)])


def inverse_network(most_words: int) -> list[int]:
    spans = (
        Span.of(Signal(DEMAND, 0), -1500.0, 1500.0),
        *(Span.of(signal(QUANTITIES[2 + i % 2], 0), -1.0, 1.0) for i in range(7)),
    )
    section = NetworkSection(spans, 1, MOST_mA, dense_layers(16), 1000, RATE_Hz)
    return NetworkTrackTable((section,)).words()


MAKERS: dict[kinds.Kind, Callable[[int], list[int]]] = {
    kinds.RULES: rules,
    kinds.PULSES: pulses,
    kinds.LINEAR: linear,
    kinds.SIGNS: signs,
    kinds.POLYNOMIAL: polynomial,
    kinds.NETWORK: network,
    kinds.RULES_ON_SIGNALS: rules_on_signals,
    kinds.MAP: damper_map,
    kinds.BANK: bank,
    kinds.INVERSE_NETWORK: inverse_network,
}


def largest(sample: Sample, most_words: int) -> Sample:
    """The sample with that table as its second one; what has one size stays as it is."""
    make = MAKERS.get(sample.kind)
    return sample if make is None else replace(sample, second=(make(most_words), 0))
