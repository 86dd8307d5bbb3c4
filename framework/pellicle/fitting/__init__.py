"""From a measured curve of force to the modulus and the tension."""
