"""Terms of the kernel of both bodies, a module each: what a body adds to homogeneous half-spaces.

A module of this folder has one function, to which :func:`terms` leads without a list of the modules::

    def term(bodies: Bodies, mesh: Mesh) -> Kernel | None

It returns what it adds to the kernel K of the homogeneous half-spaces, in the unit of K, or None for bodies
that it does not concern; the part of body i has the factor ``bodies.shares[i]``, its share of the compliance.
A new kind of body is then a module here and its key, which names the assumptions that it breaks. This gives
up an order of the terms: their sum has none.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable
from importlib import import_module
from typing import Any


def terms() -> list[Callable[..., Any]]:
    """The functions `term` of all modules of this folder."""
    names = sorted(module.name for module in pkgutil.iter_modules(__path__))
    return [import_module(f"{__name__}.{name}").term for name in names]
