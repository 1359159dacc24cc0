"""Laws with gains: one search and one budget for all of them, on an ensemble of records."""
