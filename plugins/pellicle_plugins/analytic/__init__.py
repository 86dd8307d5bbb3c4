"""Closed forms and semi-analytic solutions that numerical results are judged by."""
