__all__: list[str]

from .config import FitConfig as FitConfig
from .estimation.intervals import Estimate as Estimate
from .files.measurement import Measurement as Measurement
from .files.sources import read_curves as read_curves
from .fits import fit as fit
from .fits import fit_many as fit_many
from .fits import fit_map as fit_map
from .fits import fit_pooled as fit_pooled
from .result import Fit as Fit
