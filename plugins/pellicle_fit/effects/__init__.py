"""The effects that are shipped, one file each."""
