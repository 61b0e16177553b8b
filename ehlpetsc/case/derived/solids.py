"""Keys of `[contact]` derived from named steels."""

from ehlpetsc.materials import DEFAULT, STEELS, cyclic_strength, flow_pressure

FATIGUE_KEYS = ("fatigue_strength", "fatigue_ductility", "b", "c", "cyclic_hardening", "cyclic_strength")
BY_MATERIAL = "material"


def named_steels(material):
    """Steel of each surface; by default the default steel.

    Parameters
    ----------
    material : str, list of str or None
        ``contact.material``.

    Returns
    -------
    tuple of ehlpetsc.materials.Steel

    Raises
    ------
    KeyError
        No steel of that name.
    """
    names = [material or DEFAULT] * 2 if material is None or isinstance(material, str) else material
    first, second = names
    return STEELS[first], STEELS[second]


def fatigue_constants(steel, post):
    """Fatigue constants of a steel by key, overridden by the keys of `[post]`.

    If `[post]` has no K', it follows from the other constants.

    Parameters
    ----------
    steel : ehlpetsc.materials.Steel
    post : dict
        Keys of `[post]`; None counts as missing.
    """
    constants = {key: getattr(steel, key) for key in FATIGUE_KEYS if key != "cyclic_strength"}
    constants |= {key: post[key] for key in FATIGUE_KEYS if post.get(key) is not None}
    strength, ductility, hardening = (
        constants[key] for key in ("fatigue_strength", "fatigue_ductility", "cyclic_hardening")
    )
    return {"cyclic_strength": cyclic_strength(strength, ductility, hardening)} | constants


def with_material(tables):
    """Tables of a case with the elastic constants of its steels, and with their yield pressure.

    Elastic constants that the case gives are kept; ``yield_pressure = "material"`` becomes the pressure at
    which the steel flows. Tables without a known steel, or with faults that the schema names, stay as they
    are.

    Parameters
    ----------
    tables : dict

    Returns
    -------
    dict
    """
    contact, post = tables.get("contact"), tables.get("post", {})
    if not isinstance(contact, dict) or contact.get("material") is None:
        return tables
    try:
        steels = named_steels(contact["material"])
    except (KeyError, TypeError, ValueError):
        return tables
    elastic = ("youngs_modulus", "poisson_ratio")
    filled = {key: [getattr(steel, key) for steel in steels] for key in elastic} | contact
    if contact.get("yield_pressure") == BY_MATERIAL:
        try:
            filled["yield_pressure"] = [_flow_pressure(steel, post) for steel in steels]
        except (AttributeError, TypeError, ValueError, ZeroDivisionError, OverflowError):
            return tables
    return tables | {"contact": filled}


def _flow_pressure(steel, post):
    constants = fatigue_constants(steel, post)
    return float(flow_pressure(constants["cyclic_strength"], constants["cyclic_hardening"]))
