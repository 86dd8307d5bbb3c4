"""Fits of reduced modulus and tension to measured force curves."""
