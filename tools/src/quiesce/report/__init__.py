"""The only furniture of pages and plots."""
