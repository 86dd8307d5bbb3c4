"""The elastic response of the surface and the problem of one load step."""
