"""Expected errors of the grid of a run, from the same run on coarser grids."""
