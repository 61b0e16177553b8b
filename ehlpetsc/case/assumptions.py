"""Assumptions of each feature on bodies, shape and motion; a case beyond them is refused in one sentence.

The discrete equations hold for any kernel, shape and motion. Features that compute with more - stresses below
the surface, heat in the bodies, asperities by the modulus of their body - assume more. A feature states here
what it assumes; a key that departs from it says so in its declaration (`departs`), with what it assumes
itself (`assumes`). Neither knows the other, so that a new kind of body is refused by all features that do not
know it from the first day on. Refused is the whole feature: this gives up cases in which the departure hardly
matters, as of heat below a coating of 10 nm.

What a kind of contact does not have at all is in `contacts` of its keys; what keys need is in `needs`. Scales
and formulas (`a`, `p0`, expected films, Moes' groups) are not refused: they are those of the case without the
departure, and messages say so. Held by `tests/unit/test_assumptions.py`, which walks all features over all
bodies and shapes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from ehlpetsc.base.case import KINDS, Case
from ehlpetsc.base.declarations import Key
from ehlpetsc.case.checking import attribute
from ehlpetsc.case.tables import CASE


def _free_ends(case: Case) -> str:
    has_ends = case.contact.length is not None and case.contact.free_ends
    return "free end faces of its roller" if has_ends else ""


def _line(case: Case) -> str:
    return "" if KINDS[case.kind].is_areal else "no mesh.width"


def _reversal(case: Case) -> str:
    speeds = None if case.conditions is None else case.conditions.entrainment
    return "" if speeds is None or speeds.min() >= 0.0 else "an entrainment speed that becomes negative"


def _window(case: Case) -> str:
    return "mesh.window, a part of it" if case.mesh.window else ""


def given_keys(case: Case) -> Iterator[tuple[str, Key]]:
    """Keys of the tables of a case with another value than their default, by their place."""
    for name, of_case in CASE.keys.items():
        values = getattr(case, name, None) if of_case.table else None
        for key_name, key in of_case.table.keys.items() if values is not None else ():
            value = getattr(values, attribute(key_name), None)
            if value is not None and value != key.default:
                yield f"{name}.{key_name}", key


def departing_keys(case: Case, assumed: str = "") -> list[str]:
    """Places of the keys that break an assumption, or any."""
    found = given_keys(case)
    return [place for place, key in found if key.departs and assumed in ("", key.departs)]


class Departure(NamedTuple):
    """Departure from an assumption that no single key declares.

    `of`: text of a case, "": nothing. `cure`: advice.
    """

    of: Callable[[Case], str] = lambda case: ""
    cure: str = "leave out one of both"


DEPARTURES = {
    "homogeneous bodies": Departure(),
    "half-spaces": Departure(_free_ends, "contact.free_ends = false"),
    "a parabola along the motion": Departure(),
    "a contact in the plane": Departure(
        _line, "take a strip of few rows, mesh.width = 0.5 and mesh.points_per_half_width = [50, 8]"
    ),
    "one direction of entrainment": Departure(_reversal),
    "a whole contact": Departure(_window),
    "one speed across": Departure(),
}
"""By the assumption."""


class Feature(NamedTuple):
    """A feature: whether a case has it, and what it assumes, keys of `DEPARTURES`."""

    is_in: Callable[[Case], object]
    assumes: tuple[str, ...]


FEATURES = {
    "contact.yield_pressure": Feature(
        lambda case: case.contact.yield_pressure,
        ("homogeneous bodies", "a whole contact", "one speed across"),
    ),
    "contact.asperity_height": Feature(lambda case: case.contact.asperity_height, ("homogeneous bodies",)),
    "fluid.inlet_film": Feature(
        lambda case: case.fluid and case.fluid.inlet_film, ("one direction of entrainment",)
    ),
    "[gears]": Feature(lambda case: case.gears, ("a parabola along the motion",)),
    "[heat]": Feature(lambda case: case.heat, ("homogeneous bodies", "a whole contact")),
    "[life]": Feature(lambda case: case.life, ("homogeneous bodies", "one speed across")),
    "[operation]": Feature(lambda case: case.conditions, ("a whole contact",)),
    "[surface]": Feature(
        lambda case: case.surface.body_1 or case.surface.body_2, ("one speed across",)
    ),  # which a map that moves with its rows would leave
    "[wear]": Feature(lambda case: case.wear, ("one speed across",)),
}
STRESSES = "stresses below the surface"
SMOOTH = "damage of the smooth contact"
COMMANDS = {
    STRESSES: ("homogeneous bodies", "a whole contact", "one speed across"),
    SMOOTH: ("homogeneous bodies", "a parabola along the motion", "one speed across"),
}
"""Assumptions of features that no key asks for."""


def faults(case: Case) -> Iterator[tuple[str, str]]:
    """Features of a case that assume what it does not have, with a sentence."""
    in_case = [(name, feature.assumes) for name, feature in FEATURES.items() if feature.is_in(case)]
    for name, assumes in [*in_case, *((place, key.assumes) for place, key in given_keys(case))]:
        if text := refusal(case, name, assumes):
            yield name, text


def refusal(case: Case, name: str, assumes: Iterable[str]) -> str:
    """Sentence on the first assumption of a feature that a case does not meet; "": it meets all."""
    for assumed in assumes:
        departure = DEPARTURES[assumed]
        if text := departure.of(case) or next(iter(departing_keys(case, assumed)), ""):
            return f"{name}: assumes {assumed}, and this case has {text}; {departure.cure}"
    return ""
