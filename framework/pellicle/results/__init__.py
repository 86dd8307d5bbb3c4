"""Results: their variables and their HDF5 files."""
