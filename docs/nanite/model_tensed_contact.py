"""Model of nanite and PyJibe: a paraboloid on a soft solid, or layer, under surface tension.

Load it with ``nanite.model.load_model_from_file("model_tensed_contact.py", register=True)``, or in
PyJibe as an extension in its preferences.  It needs pellicle beside nanite: ``pip install
'pellicle[nanite]'``.
"""

import lmfit
import numpy as np

import pellicle


def get_parameter_defaults():
    """Return the parameters with their initial values and limits."""
    params = lmfit.Parameters()
    params.add("E", value=3e3, min=1e-3)
    params.add("R", value=10e-6, min=0, vary=False)
    params.add("nu", value=0.5, min=0, max=0.5, vary=False)
    # lmfit resolves a value with one bound only to 1e-16, which is coarse for its derivatives.
    params.add("tension", value=1e-4, min=0, max=10)
    params.add("thickness", value=0, min=0, vary=False)
    params.add("contact_point", value=0)
    params.add("baseline", value=0)
    return params


def compute_ancillaries(idnt):
    """Return initial values: the fit without tension, since a search from afar sticks at it."""
    tip, force = (np.asarray(idnt.appr[name]) for name in ("tip position", "force"))
    few = slice(None, None, max(1, tip.size // 500))

    def residuals(params):
        return tensed_contact(tip[few], **params.valuesdict()) - force[few]

    params = get_parameter_defaults()
    params["tension"].set(value=0, vary=False)
    fitted = lmfit.minimize(residuals, params).params
    return {key: fitted[key].value for key in parameter_anc_keys}


def tensed_contact(delta, E, R, nu, tension, thickness=0, contact_point=0, baseline=0):  # noqa: N803
    r"""Paraboloid on an elastic solid whose surface is under tension.

    .. math::

        F = \frac{E}{1-\nu^2} \, f(\delta, s), \quad s = \frac{2 \tau_0 (1-\nu^2)}{E}

    where :math:`f` solves the integral equation of axisymmetric contact under
    tension. Without tension, on a thick solid, it is the model of Hertz.

    Parameters
    ----------
    delta: 1d ndarray
        Indentation [m]
    E: float
        Young's modulus [N/m²]
    R: float
        Tip radius [m]
    nu: float
        Poisson's ratio
    tension: float
        Surface tension [N/m]
    thickness: float
        Thickness of a sample that is bonded to a rigid base [m]; 0 for one so
        thick that it does not matter
    contact_point: float
        Indentation offset [m]
    baseline: float
        Force offset [N]

    Returns
    -------
    F: float
        Force [N]

    Notes
    -----
    The contact is frictionless and without adhesion, the solid elastic. A
    fit of one curve trades tension off against modulus: see the intervals
    and the checks of ``pellicle fit``.
    """
    indenter = pellicle.indenter("paraboloid", radius=R)
    modulus = E / (1 - nu**2)
    length = 2 * tension / modulus
    depth = np.maximum(contact_point - np.asarray(delta, dtype=float), 0)
    if not thickness:
        return modulus * indenter.force_curve(depth, length).force + baseline
    # A search may look beyond the deepest layer that is tabulated.
    inside = np.minimum(depth, indenter.layer_depth_limit(thickness, nu))
    curve = indenter.layer_force_curve(inside, length, thickness, nu)
    return modulus * (curve.force + curve.by_depth * (depth - inside)) + baseline


model_doc = tensed_contact.__doc__
model_func = tensed_contact
model_key = "tensed_contact"
model_name = "parabolic indenter, tensed surface (pellicle)"
parameter_keys = ["E", "R", "nu", "tension", "thickness", "contact_point", "baseline"]
parameter_names = [
    "Young's Modulus",
    "Tip Radius",
    "Poisson's Ratio",
    "Surface Tension",
    "Sample Thickness",
    "Contact Point",
    "Force Baseline",
]
parameter_units = ["Pa", "m", "", "N/m", "m", "m", "N"]
parameter_anc_keys = ["E", "contact_point", "baseline"]
parameter_anc_names = [
    "Young's Modulus without Tension",
    "Contact Point without Tension",
    "Force Baseline without Tension",
]
parameter_anc_units = ["Pa", "m", "N"]
valid_axes_x = ["tip position"]
valid_axes_y = ["force"]
