"""Known results, with which runs are compared."""
