"""Figures of the controller on boards of any size."""
