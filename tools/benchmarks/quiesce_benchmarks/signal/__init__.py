"""Benchmark of the sensing chain."""
