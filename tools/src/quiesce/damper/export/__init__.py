"""Damper models for other programs: C and MAT files."""
