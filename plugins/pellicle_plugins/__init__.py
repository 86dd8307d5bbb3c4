"""The components that pellicle ships, each registered as a stranger's would be."""
