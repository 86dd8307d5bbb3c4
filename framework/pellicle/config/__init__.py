"""The configuration of runs and studies."""
