"""Studies: many runs and the table of their numbers."""
