"""Populations of curves: which are accepted, their groups, and their statistics."""
