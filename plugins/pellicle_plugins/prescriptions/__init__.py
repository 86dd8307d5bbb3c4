"""What load steps prescribe."""
