"""Closed-form and semi-analytic solutions to which numerical results are compared."""
