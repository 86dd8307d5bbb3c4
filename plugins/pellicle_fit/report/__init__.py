"""Figures and pages of fits."""
