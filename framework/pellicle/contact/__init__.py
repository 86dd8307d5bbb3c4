"""The problem of one load step, its solution and what is measured of it."""

import lazy_loader

# The public names are in __init__.pyi: of what needs one of them the others cost nothing.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
