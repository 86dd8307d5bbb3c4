"""Outputs of runs and studies."""
