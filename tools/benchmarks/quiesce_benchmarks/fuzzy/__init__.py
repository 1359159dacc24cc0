"""Benchmark of the fuzzy engine."""
