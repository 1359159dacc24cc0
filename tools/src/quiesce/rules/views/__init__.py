"""Rule bases and their differences drawn and told."""
