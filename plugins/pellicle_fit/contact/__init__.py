"""The elastic contact that effects act on, and the curve that they explain."""

from .contact import Contact as Contact
from .curve import Curve as Curve
