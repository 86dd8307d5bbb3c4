"""Executors, which execute the runs of a study."""
