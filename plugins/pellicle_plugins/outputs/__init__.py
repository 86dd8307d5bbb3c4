"""Outputs: what a run leaves behind."""
