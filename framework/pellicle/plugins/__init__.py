"""Plugins: how components, commands and names of packages are found, loaded and checked."""
