"""A rig in the computer."""
