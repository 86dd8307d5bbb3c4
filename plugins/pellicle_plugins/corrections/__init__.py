"""Corrections of the contact area for the discretisation."""
