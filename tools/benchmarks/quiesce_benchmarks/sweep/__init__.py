"""Benchmark of plants from recorded sweeps."""
