"""What a load step has besides its equilibrium, one file each: measures and caveats."""
