"""Models of the force at a depth."""
