"""Walks over every integer input."""
