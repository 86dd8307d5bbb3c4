"""A page on this machine on which sliders change a run and its curves follow."""
