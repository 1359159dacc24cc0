"""Searching rule bases on the simulated plant."""
