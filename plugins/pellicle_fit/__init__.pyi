__all__: list[str]

from .config import FitConfig as FitConfig
from .files.measurement import Measurement as Measurement
from .files.sources import read_curves as read_curves
from .many import fit_many as fit_many
from .maps import fit_map as fit_map
from .one_curve import Fit as Fit
from .one_curve import fit as fit
from .pooled import PooledCurve as PooledCurve
from .pooled import PooledFit as PooledFit
from .pooled import fit_pooled as fit_pooled
from .statistics.profile import Estimate as Estimate
