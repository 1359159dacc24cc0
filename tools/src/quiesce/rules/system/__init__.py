"""Fuzzy systems of any kind: what a rule file can say beyond a plain rule base."""
