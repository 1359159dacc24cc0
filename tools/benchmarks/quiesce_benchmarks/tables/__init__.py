"""The road of a table: into a controller at work, into its memory, and back."""
