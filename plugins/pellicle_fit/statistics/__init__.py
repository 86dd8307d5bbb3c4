"""Statistics of fits: likelihoods, intervals, checks."""
