"""Fuzzy rule bases: read, write, compile to integers, check, draw, optimise."""
