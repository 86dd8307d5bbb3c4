"""What to expect of the grid of a run, from the same run on coarser grids."""
