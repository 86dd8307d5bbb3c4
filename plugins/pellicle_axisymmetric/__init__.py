"""Axisymmetric contact under surface tension, of any rigid body of revolution.

An indenter that derives from `BodyOfRevolution` needs its profile and `abel_slope`.
"""

from .adhesion_from_path import AdhesiveContact as AdhesiveContact
from .adhesion_from_path import AdhesiveCurve as AdhesiveCurve
from .adhesion_from_path import adhesive_curve as adhesive_curve
from .adhesive_contact import Adhesion as Adhesion
from .adhesive_contact import punch_pull_off as punch_pull_off
from .arguments import positive as positive
from .arguments import single as single
from .body import BodyOfRevolution as BodyOfRevolution
from .depth_curves import contact_part as contact_part
from .depth_curves import fill_curve as fill_curve
from .depth_curves import force_curve as force_curve
from .depth_curves import stretch_curve as stretch_curve
from .dynamic_punch import dynamic_punch_stiffness as dynamic_punch_stiffness
from .equation import kinks_of as kinks_of
from .indentation import AxisymmetricContact as AxisymmetricContact
from .indentation import indent as indent
from .layer_curves import Profile as Profile
from .layer_curves import Punch as Punch
from .layer_curves import TensedLayer as TensedLayer
from .layer_curves import cone_profile as cone_profile
from .layer_curves import smooth_profile as smooth_profile
from .master_curves import cone as cone
from .master_curves import flat_punch as flat_punch
from .master_curves import paraboloid as paraboloid
from .master_curves import punch_radius as punch_radius
from .reciprocity import Contacts as Contacts
from .reciprocity import contacts as contacts
from .splines import Interpolant as Interpolant
from .splines import stretched_spline as stretched_spline
from .tensed_punch import TensedPunch as TensedPunch
from .tensed_punch import punch as punch
