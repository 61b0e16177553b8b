"""Laws of the oil as entries of tables: function, constants and keys; their call in compiled loops.

A law is one function of numbers or arrays in SI units, which carries complex arguments through, with its
constants and the keys of `[fluid]` that it reads. Compiled loops call the functions of a table by their
position, or, of a user's law, by its address.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from types import SimpleNamespace
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from ehlpetsc.base.compiled import inlined
from ehlpetsc.base.declarations import Key, Values

SLOTS = 10  # constants that compiled loops get of any law
STANDARD_TEMPERATURE = 313.15  # K, where a case has no temperature
PRIVATE = {"cache": False, "no_cpython_wrapper": True}  # called by compiled functions alone
Numbers: TypeAlias = float | np.ndarray
Derivatives = tuple[Any, ...]
FluidValues = SimpleNamespace  # of [fluid], checked or to be completed


@dataclass(frozen=True)
class Law:
    """A law of the oil.

    Attributes
    ----------
    function
        Value and derivatives of the state and of the constants: (p, T) of a viscosity law, (p,) of a density
        law, (x,) of a shear law, see :func:`ehlpetsc.physics.oil.rheology.flow_stress`.
    constants
        Of the function, from the tables `[fluid]` and `[heat]` of a case (None: isothermal); the first one
        of a viscosity law is a factor of the logarithm, that of a shear law of the stress.
    keys
        Of `[fluid]` that belong to this law.
    complete
        Values of keys that are left out; raises `Refused` where one is missing or impossible.
    of_temperature
        Whether it has a temperature of its own in isothermal cases too.
    """

    function: Callable[..., Derivatives]
    constants: Callable[[FluidValues, Values | None], tuple[float, ...]]
    equation: str
    keys: Mapping[str, Key] = field(default_factory=dict)
    complete: Callable[[FluidValues], Mapping[str, Any]] = lambda fluid: {}
    of_temperature: bool = False

    def __call__(self, *arguments: Any) -> Derivatives:
        """Value and derivatives of the state, by its constants, which may be padded."""
        *state, constants = arguments
        return self.function(*state, *constants[: n_constants(self.function, len(state))])


class OilLaw(NamedTuple):
    """A viscosity or density law, by its position or address, with its constants, for compiled loops."""

    kind: int
    constants: tuple[float, ...]
    temperature: float = STANDARD_TEMPERATURE  # at which `fluid.viscosity` holds [K]


@cache
def n_constants(function: Callable[..., Derivatives], state: int) -> int:
    """Number of constants of a law of `state` variables."""
    return len(inspect.signature(function).parameters) - state


def switched(laws: Mapping[str, Law], state: int, pair: bool = False) -> Callable[..., Derivatives]:
    """Compiled function of (kind, (p,) or (p, T), constants) over a table of laws; pair: (p, T, T)."""
    functions = [law.function for law in laws.values()]
    call: Callable[..., Derivatives] | None = None
    for kind in reversed(range(len(functions))):
        call = _or_else(functions[kind], kind, call, state, pair)
    return call


def _or_else(
    function: Callable[..., Derivatives],
    kind: int,
    other: Callable[..., Derivatives] | None,
    state: int,
    pair: bool,
) -> Callable[..., Derivatives]:
    count, law = n_constants(function, state), inlined(function, **PRIVATE)
    if pair:  # in one branch: what depends on p alone is computed once

        def here(at: tuple, c: tuple[float, ...]) -> Derivatives:
            return law(at[0], at[1], *c[:count]), law(at[0], at[2], *c[:count])

    else:

        def here(at: tuple, c: tuple[float, ...]) -> Derivatives:
            return law(*(at + c[:count]))

    here = inlined(here, **PRIVATE)
    if other is None:

        def call(k: int, at: tuple, c: tuple[float, ...]) -> Derivatives:
            return here(at, c)

    else:

        def call(k: int, at: tuple, c: tuple[float, ...]) -> Derivatives:
            return here(at, c) if k == kind else other(k, at, c)

    return inlined(call, cache=False, no_cpython_wrapper=kind > 0)  # Python calls the whole alone


def padded(constants: tuple[float, ...]) -> tuple[float, ...]:
    return (*map(float, constants), *[0.0] * (SLOTS - len(constants)))
