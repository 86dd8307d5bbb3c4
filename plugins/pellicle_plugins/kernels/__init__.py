"""Kernels: how the surface yields to pressure."""
