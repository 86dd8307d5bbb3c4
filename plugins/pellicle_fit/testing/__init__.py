"""The contracts of fits as tests: one call checks a component."""

from .effects import check_effect as check_effect
from .readers import check_reader as check_reader
