"""Recordings through the sensing chain, and what the chain does to a tone."""
