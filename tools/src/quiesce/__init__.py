"""Quiesce: command line around the controller for magnetorheological dampers and its bench."""

__version__ = "0.1.0"
