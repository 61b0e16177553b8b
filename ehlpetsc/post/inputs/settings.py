"""What the case text inside a result file says about the material and the depths."""

import difflib
import math
import tomllib
from typing import NamedTuple

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.post.criteria.laws import Criteria
from ehlpetsc.post.fatigue.strain_life import Material
from ehlpetsc.post.inputs.reading import in_words

FATIGUE_KEYS = ("b", "c", "cyclic_hardening", "fatigue_strength", "fatigue_ductility", "cyclic_strength")
CRITERIA_KEYS = ("normal_sensitivity", "yield_strength", "torsion_limit", "bending_limit")
KEYS = ("depths", *FATIGUE_KEYS, *CRITERIA_KEYS, "residual_stress")
TABLES = ("contact", "motion", "mesh", "time", "output", "post")
LARGEST_RESIDUAL = 1e10  # Pa
DEEPEST = 100.0  # half widths; below it the stresses of a line contact are no one's concern
MOST_DEPTHS = 1000
DEPTHS = (
    0.0,
    0.01,
    0.03,
    0.05,
    0.1,
    0.2,
    0.5,
)  # where [post] names none: those of the paper and some between


class Settings(NamedTuple):
    """Depths z/a, one material a surface, constants of the criteria, residual stress (z/a, Pa)."""

    depths: tuple
    fast: Material
    slow: Material
    criteria: Criteria = Criteria()
    residual_stress: tuple = ()

    def residual(self, depth):
        """Residual stress along the surface at a depth z/a, Pa: straight lines, constant beyond its ends."""
        if not self.residual_stress:
            return 0.0
        depths, values = zip(*self.residual_stress, strict=True)
        return float(np.interp(depth, depths, values))


def is_number(value):
    """Whether a value of a case is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < math.inf


def _depths(values, faults):
    if not isinstance(values, list | tuple) or not values:
        faults.append("post.depths: must be a list of z/a values")
        return ()
    if not all(is_number(v) and 0 <= v <= DEEPEST for v in values) or len(values) > MOST_DEPTHS:
        faults.append(
            f"post.depths = {in_words(list(values))}: every depth must be a finite number, 0 or more and at "
            f"most {DEEPEST:g}, and they at most {MOST_DEPTHS}"
        )
        return ()
    return tuple(sorted({float(v) for v in values}))


def _materials(contact, post, faults):
    constants = {key: post[key] for key in FATIGUE_KEYS if key in post}
    for key, value in constants.items():
        if not is_number(value):
            faults.append(f"post.{key} = {value!r}: must be a finite number")
            return None, None
    pairs = []
    for key in ("youngs_modulus", "poisson_ratio"):
        pair = contact.get(key)
        if not (isinstance(pair, list) and len(pair) == 2 and all(is_number(v) for v in pair)):
            faults.append(f"contact.{key} = {pair!r}: must be two numbers, one a surface")
            return None, None
        pairs.append(pair)
    try:  # surface 1 is the fast one
        return tuple(Material(E, nu, **constants) for E, nu in zip(*pairs, strict=True))
    except ValueError as fault:
        faults.append(f"post.{fault}")
        return None, None


def _criteria(post, faults):
    constants = {key: post[key] for key in CRITERIA_KEYS if key in post}
    for key, value in constants.items():
        if not is_number(value):
            faults.append(f"post.{key} = {in_words(value)}: must be a finite number")
            return Criteria()
    try:
        return Criteria(**constants)
    except ValueError as fault:
        faults.append(f"post.{fault}")
        return Criteria()


def _residual_stress(rows, faults):
    whole = isinstance(rows, list) and all(
        isinstance(row, list) and len(row) == 2 and all(map(is_number, row)) for row in rows
    )
    depths = [row[0] for row in rows] if whole else []
    if not whole or any(depth < 0 for depth in depths) or sorted(set(depths)) != depths:
        faults.append(
            f"post.residual_stress = {in_words(rows)}: must be a list of [z/a, Pa], its "
            "depths 0 or more and rising"
        )
        return ()
    if any(abs(row[1]) > LARGEST_RESIDUAL for row in rows):
        faults.append(f"post.residual_stress = {in_words(rows)}: beyond {LARGEST_RESIDUAL:g} Pa")
        return ()
    return tuple((float(depth), float(value)) for depth, value in rows)


def parse_case(text):
    """The tables of a case text, each a dict; those it does not have are empty.

    Raises
    ------
    PostError
        It is not TOML, or what should be a table is none.
    """
    try:
        case = tomllib.loads(text)
    except (ValueError, RecursionError) as fault:
        raise PostError(f"attribute case: the case text is not valid TOML: {in_words(fault)}") from None
    tables = {name: case.get(name, {}) for name in TABLES}
    for name, table in tables.items():
        if not isinstance(table, dict):
            raise PostError(f"attribute case: {name} must be a table")
    return tables


def read_settings(case, depths=None):
    """Settings from a parsed case; `depths` replaces those of [post].

    Raises
    ------
    PostError
        One line a fault: an unknown key in [post], a value out of range.
    """
    post, faults = case["post"], []
    for key in post:
        if key not in KEYS:
            near = difflib.get_close_matches(key, KEYS, 1)
            faults.append(f"post.{key}: no such key" + (f", did you mean {near[0]}?" if near else ""))
    chosen = _depths(depths if depths is not None else post.get("depths", DEPTHS), faults)
    fast, slow = _materials(case["contact"], post, faults)
    criteria = _criteria(post, faults)
    residual = _residual_stress(post.get("residual_stress", []), faults)
    if faults:
        raise PostError("\n".join(faults))
    return Settings(chosen, fast, slow, criteria, residual)
