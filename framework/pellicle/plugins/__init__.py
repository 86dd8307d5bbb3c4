"""What brings components, commands and names to pellicle: how it is found, loaded and checked."""
