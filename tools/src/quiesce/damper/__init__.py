"""Damper models from measurements: data, fits, reports."""
