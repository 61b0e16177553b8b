"""Hints in error messages on a case: similar key, missing power of ten, physics not modelled."""

import difflib
import math

from ehlpetsc.case.schema.table import item_type

MAX_NUMBER = 1e100
USUAL_POWERS = {"Pa": (9, 6), "1/Pa": (-9,), "m": (-3, -6, -9)}  # of ten, of usual units
SYNONYMS = {
    "movement": "motion",
    "velocity": "motion",
    "kinematics": "motion",
    "oil": "fluid",
    "lubricant": "fluid",
    "grid": "mesh",
    "speed": "entrainment_speed",
    "slip": "slide_roll_ratio",
    "friction": "boundary_friction",
    "friction_coefficient": "boundary_friction",
    "eta": "viscosity",
    "eta0": "viscosity",
    "alpha": "pressure_viscosity",
    "e": "youngs_modulus",
    "nu": "poisson_ratio",
    "r": "radius",
    "w": "load",
}
ELSEWHERE = {
    "temperature": "temperatures are in [heat]: bulk_temperature, inlet_temperature",
    "thermal": "a [heat] table computes with temperatures",
    "archard": "wear is in [wear]: coefficient",
    "hardness": "contact.material or contact.yield_pressure set where asperities yield",
}
NOT_MODELLED = {
    "radius_x": "the contact is a line contact: one radius in the direction of motion",
    "radius_y": "the contact is a line contact: one radius in the direction of motion",
    "ellipticity": "the contact is a line contact",
    "mass": "inertia is neglected: the load is in balance at every step",
    "damping": "inertia is neglected: the load is in balance at every step",
    "side_leakage": "the contact is a line contact: no flow across the direction of motion",
}


def not_modelled(where, name):
    """Hint to a key of another table, or that the physics is not modelled; "" otherwise."""
    if name in ELSEWHERE:
        return ELSEWHERE[name]
    if name == "type" and where == "contact.":
        return "not modelled: point contacts; the contact is always a line contact"
    return f"not modelled: {NOT_MODELLED[name]}" if name in NOT_MODELLED else ""


def slip(field, value):
    """Hint to a missing power of ten, as in 206 for 206e9."""
    type_ = item_type(field)
    low, high = (getattr(type_, name, None) for name in ("ge", "le"))
    number = value[0] if isinstance(value, (list, tuple)) and value else value
    if isinstance(number, bool) or not isinstance(number, int | float) or low is None:
        return ""
    if not 0.0 < abs(number) < MAX_NUMBER:  # an integer of thousands of digits is no float
        return ""
    unit = field.field_info.extra.get("unit", "")
    for power in USUAL_POWERS.get(unit, ()):
        if low <= number * 10.0**power <= (high or math.inf) and not low <= number <= (high or math.inf):
            return f"; {number:g}e{power:d}?"
    return ""


def nearest(name, model):
    """Hint to the most similar key."""
    keys = [f.alias for f in model.__fields__.values()]
    close = difflib.get_close_matches(name, keys, n=1)
    if SYNONYMS.get(name.lower()) in keys:
        close = [SYNONYMS[name.lower()]]
    return f'did you mean "{close[0]}"?' if close else f"allowed: {', '.join(keys)}"
