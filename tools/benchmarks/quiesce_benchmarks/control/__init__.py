"""Benchmark of control laws against the best attainable."""
