"""Frozen models of a configuration: error messages, dotted paths, ranges, TOML."""

import lazy_loader

# The public names are in __init__.pyi. Of a package that needs one of them the others cost nothing.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
