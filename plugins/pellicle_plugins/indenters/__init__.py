"""Indenters, the rigid bodies pressed into the surface."""
