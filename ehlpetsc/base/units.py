"""Values with a unit, as in ``load = "350 N/mm"``, and units in headings of tables: conversion to SI."""

from __future__ import annotations

import re
from functools import cache
from math import pi

PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "h": 1e2, "d": 1e-1, "c": 1e-2, "m": 1e-3, "u": 1e-6, "n": 1e-9}
BASE = ("m", "kg", "s", "K", "rad")
PREFIXED = {  # units that take a prefix, by others
    "m": "m",
    "g": "0.001 kg",
    "s": "s",
    "K": "K",
    "rad": "rad",
    "N": "kg m/s^2",
    "Pa": "N/m^2",
    "J": "N m",
    "W": "J/s",
    "Hz": "1/s",
    "bar": "1e5 Pa",
    "P": "0.1 Pa s",
    "St": "1e-4 m^2/s",
    "Nm": "N m",
    "Nmm": "0.001 N m",
    "Pas": "Pa s",
}
FURTHER = {
    "min": "60 s",
    "minutes": "60 s",
    "h": "3600 s",
    "l": "0.001 m^3",
    "deg": f"{pi / 180!r} rad",
    "degrees": "deg",
    "°": "deg",
    "rev": f"{2 * pi!r} rad",
    "turn": "rev",
    "rpm": "rev/min",
    "rps": "rev/s",
    "in": "0.0254 m",
    "ft": "0.3048 m",
    "lbf": "4.4482216152605 N",
    "psi": "lbf/in^2",
    "degC": "K",
    "°C": "K",
    "C": "K",
    "degF": f"{5 / 9!r} K",
    "%": "0.01",
}
ZEROS = {"degC": 273.15, "°C": 273.15, "C": 273.15, "degF": 459.67 * 5 / 9}  # K
UNIT_SIGNS = str.maketrans({"µ": "u", "μ": "u", "·": "*", "⋅": "*"} | {"²": "^2", "³": "^3"})
VALUE = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s.].*|1\s*/.*)")
PLAIN_NUMBER = re.compile(r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*")
COMMA = re.compile(r"\s*[-+]?[\d.]*,[\d.,]*\d.*|\s*[-+]?\d[\d.]*,.*")
TOKEN = r"\s*(?:(\d+\.?\d*(?:e[-+]?\d+)?)|([A-Za-z%°]+)(?:(?:\^|\*\*)?([-+]?\d))?|([*/()]))"
ANY = "a number, or %"  # where there is no unit
UNIT_SAMPLES = "a product of such as N, kN, GPa, um, mm, ms, rpm"
OIL_DENSITY = 870.0  # kg/m^3, of the example in a message
MAX_DIGITS = 15  # of a converted number: 5 um is 5e-6, not 4.9999999999999996e-06


class UnitFault(ValueError):
    """A value with a unit cannot be converted; the message states the reason."""


def converted(value: object, unit: str, is_difference: bool = False, depth: int = 2) -> object:
    """Number in `unit` of a text with a unit, also in lists; other values do not change.

    `is_difference`: of temperatures, which have no zero to add.
    """
    if isinstance(value, list) and depth:
        return [converted(item, unit, is_difference, depth - 1) for item in value]
    match = VALUE.fullmatch(value) if isinstance(value, str) else None
    if isinstance(value, str) and COMMA.fullmatch(value):
        point = value.replace(".", "").replace(",", ".", 1).strip()
        raise UnitFault(f'"{value}": a comma in a number; allowed: digits and a decimal point, as "{point}"')
    if isinstance(value, str) and PLAIN_NUMBER.fullmatch(value):
        raise UnitFault(f'"{value}": a number in quotation marks; allowed: {float(value)!r}')
    if not match:
        return value
    number, text = float(match[1]), match[2].strip()
    try:
        zero = ZEROS.get(text, 0.0) if unit == "K" and not is_difference else 0.0
        return float(f"{number * factor(text, unit, number) + zero:.{MAX_DIGITS}g}")
    except UnitFault as fault:
        raise UnitFault(f'"{value}": {fault}') from None


def factor(text: str, unit: str, number: float = 1.0) -> float:
    """Number of `unit` in one unit of `text`: 1000 of "kN" in "N".

    A rate [1/min] counts revolutions: an angle over time is divided by that of a revolution.

    `number`: value in `text`, for messages.
    """
    try:
        size, dimensions = _unit(text)
    except (KeyError, IndexError, OverflowError, ZeroDivisionError):
        allowed = f"a number in {unit}, or with a unit, {UNIT_SAMPLES}" if unit else ANY
        raise UnitFault(f"unknown unit; allowed: {allowed}") from None
    wanted_size, wanted = _unit(unit)
    if unit == "1/min" and dimensions == (*wanted[:-1], 1):
        size, dimensions = size / (2 * pi), wanted
    kinematic, dynamic = _unit("m^2/s")[1], _unit("Pa s")[1]
    if (dimensions, wanted) == (kinematic, dynamic):
        value = 1e3 * number * size * OIL_DENSITY
        raise UnitFault(
            f"kinematic, and this key is dynamic; allowed: this times the density, at {OIL_DENSITY:g} kg/m^3 "
            f'"{value:.4g} mPa s"'
        )
    if (dimensions, wanted) == (dynamic, kinematic):
        value = 1e6 * number * size / OIL_DENSITY
        raise UnitFault(
            f"dynamic, and this key is kinematic; allowed: this over the density, at {OIL_DENSITY:g} kg/m^3 "
            f'"{value:.4g} cSt"'
        )
    if dimensions != wanted:
        raise UnitFault(f"not a unit of this key; allowed: {f'a unit of {unit}' if unit else ANY}")
    return size / wanted_size


@cache
def _unit(text: str) -> tuple[float, tuple[int, ...]]:
    """SI size and exponents of `BASE` of a product of units, read from left to right."""
    text = text.translate(UNIT_SIGNS).strip()
    if re.sub(TOKEN, "", text):
        raise KeyError(text)
    size, exponents, sign, outer = 1.0, [0] * len(BASE), 1, [1]
    for number, name, power, mark in re.findall(TOKEN, text):
        if mark == "(":
            outer.append(sign * outer[-1])
        elif mark == ")":
            outer.pop()
        if mark:
            sign = -1 if mark == "/" else 1
            continue
        one, dimensions = _named(name) if name else (float(number), (0,) * len(BASE))
        exponent, sign = sign * outer[-1] * int(power or 1), 1
        size *= one**exponent
        exponents = [e + exponent * d for e, d in zip(exponents, dimensions, strict=True)]
    if outer != [1]:
        raise KeyError(text)
    return size, tuple(exponents)


def _named(name: str) -> tuple[float, tuple[int, ...]]:
    """Unit of a symbol, also with a prefix."""
    if name in BASE:
        return 1.0, tuple(int(name == base) for base in BASE)
    if name in FURTHER or name in PREFIXED:
        return _unit((FURTHER | PREFIXED)[name])
    size, dimensions = _unit(PREFIXED[name[1:]]) if name[1:] in PREFIXED else _unit(f"[{name}")
    return PREFIXES[name[0]] * size, dimensions
