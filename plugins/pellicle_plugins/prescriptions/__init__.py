"""Prescriptions of load steps."""
