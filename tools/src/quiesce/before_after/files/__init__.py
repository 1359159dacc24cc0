"""Recordings of every kind: which channels they have, and what a channel's samples are."""
