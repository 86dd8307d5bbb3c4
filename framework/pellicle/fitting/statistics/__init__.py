"""What a curve can tell: likelihoods, intervals, checks."""
