"""What components keep, asked without a run."""
