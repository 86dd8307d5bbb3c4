"""The elastic response of the surface: from a kernel to the operator of a grid."""

import lazy_loader

# The public names are in __init__.pyi: of what needs one of them the others cost nothing.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
