"""Readers of files that pellicle ships, one class for each maker or kind of file."""
