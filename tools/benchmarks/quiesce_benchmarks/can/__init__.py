"""Benchmark of the CAN interface."""
