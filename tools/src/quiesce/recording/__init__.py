"""Recordings of whatever format, as columns with names and units."""
