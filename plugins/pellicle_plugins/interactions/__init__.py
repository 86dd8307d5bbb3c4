"""Interactions: the traction that acts across the gap."""
