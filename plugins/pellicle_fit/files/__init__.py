"""Measured curves and the files that hold them."""
