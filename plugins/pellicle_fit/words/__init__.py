"""What fits say, in words."""
