"""Quantities of an explanation from curves: χ², searches, starts, intervals and the noise."""
