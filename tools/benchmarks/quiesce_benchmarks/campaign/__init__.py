"""Benchmark of campaigns."""
