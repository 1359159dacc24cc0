"""Benchmark of damper models and their identification."""
