"""Laws side by side: the same structure, the same ground motions, the same noise."""
