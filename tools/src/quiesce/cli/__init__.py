"""The command line: one module a command; only here are arguments parsed and results printed."""
