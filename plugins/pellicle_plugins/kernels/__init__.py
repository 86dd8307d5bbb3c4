"""Kernels, which give the displacement of the surface under pressure."""
