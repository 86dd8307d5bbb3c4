"""Solvers: from a problem to its pressure."""
