"""Tunes the pulses of the phase law to a plant."""
