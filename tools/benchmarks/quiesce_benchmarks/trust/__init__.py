"""Benchmark of trust: what mistakes in the guarding code, abuse and memory faults lead to."""
