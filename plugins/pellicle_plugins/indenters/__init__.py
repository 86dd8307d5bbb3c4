"""Indenters: the rigid bodies that are pressed in."""
