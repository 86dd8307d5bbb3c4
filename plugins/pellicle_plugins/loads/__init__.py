"""Loads: known tractions on the surface."""
