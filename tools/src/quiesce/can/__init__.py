"""The CAN interface from a computer: what quiesce.dbc says, buses, logs, the actions of `can`."""
