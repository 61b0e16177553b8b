"""What the case text inside a result file says about the material and the depths."""

import difflib
import math
import tomllib
from typing import NamedTuple

from ehlpetsc.errors import PostError
from ehlpetsc.post.fatigue.strain_life import Material

FATIGUE_KEYS = ("b", "c", "cyclic_hardening", "fatigue_strength", "fatigue_ductility", "cyclic_strength")
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
    """Depths z/a and one material a surface."""

    depths: tuple
    fast: Material
    slow: Material
    transient: bool
    every: int


def _number(value):
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _depths(values, faults):
    if not isinstance(values, list | tuple) or not values:
        faults.append("post.depths: must be a list of z/a values")
        return ()
    if not all(_number(v) and v >= 0 for v in values):
        faults.append(f"post.depths = {list(values)}: every depth must be a finite number, 0 or more")
        return ()
    return tuple(sorted({float(v) for v in values}))


def _materials(contact, post, faults):
    constants = {key: post[key] for key in FATIGUE_KEYS if key in post}
    for key, value in constants.items():
        if not _number(value):
            faults.append(f"post.{key} = {value!r}: must be a finite number")
            return None, None
    pairs = []
    for key in ("youngs_modulus", "poisson_ratio"):
        pair = contact.get(key)
        if not (isinstance(pair, list) and len(pair) == 2 and all(_number(v) for v in pair)):
            faults.append(f"contact.{key} = {pair!r}: must be two numbers, one a surface")
            return None, None
        pairs.append(pair)
    try:  # surface 1 is the fast one
        return tuple(Material(E, nu, **constants) for E, nu in zip(*pairs, strict=True))
    except ValueError as fault:
        faults.append(f"post.{fault}")
        return None, None


def read_settings(text, depths=None):
    """Settings from the case text; `depths` replaces those of [post].

    Raises
    ------
    PostError
        One line a fault: TOML that cannot be read, an unknown key in [post], a value out of range.
    """
    try:
        case = tomllib.loads(text)
    except tomllib.TOMLDecodeError as fault:
        raise PostError(f"the case text stored in it is not valid TOML: {fault}") from None
    post, faults = case.get("post", {}), []
    for key in post:
        if key not in ("depths", *FATIGUE_KEYS):
            near = difflib.get_close_matches(key, ("depths", *FATIGUE_KEYS), 1)
            faults.append(f"post.{key}: no such key" + (f", did you mean {near[0]}?" if near else ""))
    chosen = _depths(depths if depths is not None else post.get("depths", DEPTHS), faults)
    fast, slow = _materials(case.get("contact", {}), post, faults)
    if faults:
        raise PostError("\n".join(faults))
    return Settings(chosen, fast, slow, "time" in case, case.get("output", {}).get("every", 1))
