"""Axisymmetric contact under surface tension: its integral equation and the curves made of it."""
