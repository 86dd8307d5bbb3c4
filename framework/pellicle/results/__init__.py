"""Results: their variables, and the one HDF5 layout that they are kept in."""
