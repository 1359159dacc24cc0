"""Doors to compiled code: the bench, its traces, the parameters, the scenarios."""
