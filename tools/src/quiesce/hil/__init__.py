"""The published scenarios in closed loop: runs, metrics, table, page."""
