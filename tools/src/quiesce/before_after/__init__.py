"""Two recordings of one structure, before and after: figures, their intervals, verdicts, a page."""
