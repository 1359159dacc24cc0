"""Damper models that are learned rather than written down: training here, running in C++
(sim_hil/damper/learned)."""

from importlib import import_module
from types import ModuleType

from quiesce.base.errors import UsageError

# Name in damper files -> module with train(segments, scales, seed, settings, progress).
MODELS = {
    "anfis": "quiesce.damper.learned.anfis",
    "feed_forward_network": "quiesce.damper.learned.feed_forward",
    "hilbert_network": "quiesce.damper.learned.hilbert",
    "hysteresis_network": "quiesce.damper.learned.hysteresis_network",
    "neuro_fuzzy_stf": "quiesce.damper.learned.self_tuning",
    "recurrent_network": "quiesce.damper.learned.recurrent",
    "support_vector": "quiesce.damper.learned.support_vector",
    "ts_fuzzy": "quiesce.damper.learned.ts_fuzzy",
}


def learner(name: str) -> ModuleType:
    """UsageError with the names that there are where there is no such model."""
    if name not in MODELS:
        raise UsageError(f"no learned model '{name}'; there are {', '.join(MODELS)}")
    return import_module(MODELS[name])
