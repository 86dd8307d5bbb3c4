"""The version of the installed distribution, and how to cite it."""

from importlib.metadata import version

__version__ = version("pellicle")
CITATION = (
    f"pellicle {__version__}: contact mechanics of soft solids under a tensed skin (software), and "
    "for the method W. Yuan and G. Wang, Boundary Element Calculations for Normal Contact of Soft "
    "Materials With Tensed Surface Membrane, 2020"
)
"""A reference for papers."""
