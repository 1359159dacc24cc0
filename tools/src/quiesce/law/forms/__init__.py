"""The kinds of table, one module each: its fields, its words, what it does in float64."""
