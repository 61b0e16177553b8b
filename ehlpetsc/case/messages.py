"""Sentences about keys and values: allowed values, similar keys, missing powers of ten, missing physics."""

from __future__ import annotations

import difflib
import json
import math
from collections.abc import Iterable

from ehlpetsc.keys import Key

MAX_NUMBER = 1e100
USUAL_POWERS = {"Pa": (9, 6), "1/Pa": (-9,), "m": (-3, -6, -9)}  # of ten, of usual units
NAMES = {bool: "true or false", int: "a whole number", float: "a number", str: "text", dict: "a table"}
PLURALS = {int: "whole numbers", float: "numbers", str: "texts"}
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


def value_text(key: Key) -> str:
    """Type, choices, bounds and unit of a key: ``a number >= 1e-09 and <= 100 [m]``."""
    text = _kind(key)
    bounds = ((">", key.gt), (">=", key.ge), ("<", key.lt), ("<=", key.le))
    text += " and".join(f" {sign} {bound:g}" for sign, bound in bounds if bound is not None)
    if key.below:
        text += f", below {key.below}"
    return f"{text} [{key.unit}]" if key.unit else text


def _kind(key: Key) -> str:
    if key.choices:
        choices = ", ".join(f'"{choice}"' for choice in key.choices)
        if key.many == "list":
            return f"a list of {choices}"
        return f"one of {choices}" + (", or a list of two of them" if key.many == "both" else "")
    plural = PLURALS.get(key.kind)
    if key.many == "both":
        return f"{NAMES[key.kind]} or a list of two {plural}"
    if key.many:
        return f"a list{' of two' if key.many == 'two' else ' of' if plural else ''} {plural or ''}".strip()
    return NAMES[key.kind]


def allowed(key: Key) -> str:
    """Allowed values of a key with its meaning, for messages."""
    return f"{value_text(key)} ({key.text})"


def show(value: object) -> str:
    """Value as in the case file, shortened."""
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except ValueError:  # Python does not print an integer of thousands of digits
        text = "a number of thousands of digits"
    except RecursionError:
        text = "tables in tables without end"
    text = "nan" if text == "NaN" else text
    return shortened(text.encode(errors="backslashreplace").decode())


def shortened(text: str) -> str:
    """Text shortened to 60 characters."""
    return text if len(text) <= 60 else text[:57] + "..."


def unknown(where: str, name: str, value: object, names: Iterable[str]) -> str:
    """Fault of a key that does not exist, with a hint to another one."""
    place = where + shortened(name)
    if name in ELSEWHERE:
        hint = ELSEWHERE[name]
    elif name == "type" and where == "contact.":
        hint = "not modelled: point contacts; the contact is always a line contact"
    elif name in NOT_MODELLED:
        hint = f"not modelled: {NOT_MODELLED[name]}"
    else:
        hint = nearest(shortened(name), names) or f"allowed: {', '.join(names)}"
    if isinstance(value, dict):
        return f"[{place}]: unknown table; {hint}"
    return f"{place} = {show(value)}: unknown key; {hint}"


def nearest(name: str, names: Iterable[str]) -> str:
    """Hint to the most similar name, "" without one."""
    names = list(names)
    close = difflib.get_close_matches(name, names, n=1)
    if SYNONYMS.get(name.lower()) in names:
        close = [SYNONYMS[name.lower()]]
    return f'did you mean "{close[0]}"?' if close else ""


def slip(key: Key, value: object) -> str:
    """Hint to a missing power of ten, as in 206 for 206e9, or to degrees Celsius; "" otherwise."""
    number = value[0] if key.many and isinstance(value, list | tuple) and value else value
    if isinstance(number, bool) or not isinstance(number, int | float) or key.ge is None:
        return ""
    if not 0.0 < abs(number) < MAX_NUMBER:  # an integer of thousands of digits is no float
        return ""
    high = math.inf if key.le is None else key.le
    if key.ge <= number <= high:
        return ""
    if key.unit == "K" and key.ge <= number + 273.15 <= high:
        return f'; "{number:g} degC"?'
    for power in USUAL_POWERS.get(key.unit, ()):
        if key.ge <= number * 10.0**power <= high:
            return f"; {number:g}e{power:d}?"
    return ""
