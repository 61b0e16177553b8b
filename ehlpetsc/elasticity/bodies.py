"""Elastic constants of the two bodies of a contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ehlpetsc.base.case import Contact


def reduced_modulus(youngs_modulus: Sequence[float], poisson_ratio: Sequence[float]) -> float:
    r"""Reduced modulus E' [Pa], :math:`2/E'=(1-\nu_1^2)/E_1+(1-\nu_2^2)/E_2`.

    Parameters
    ----------
    youngs_modulus, poisson_ratio
        E1, E2 [Pa] and nu1, nu2.
    """
    return 2.0 / sum((1.0 - nu * nu) / e for e, nu in zip(youngs_modulus, poisson_ratio, strict=True))


class Bodies(NamedTuple):
    r"""Elastic bodies 1 and 2.

    `modulus`: E' of both, homogeneous [Pa].
    `shares`: of the compliance :math:`2/E'`, :math:`\frac{E'}2(1-\nu_i^2)/E_i`, of each body.
    `contact`: the table [contact], for the terms of :mod:`.terms`.
    """

    modulus: float
    shares: tuple[float, float]
    contact: Contact

    @classmethod
    def of(cls, contact: Contact) -> Bodies:
        """Bodies of the table [contact]."""
        constants = contact.youngs_modulus, contact.poisson_ratio
        modulus = reduced_modulus(*constants)
        first, second = (0.5 * modulus * (1.0 - nu * nu) / e for e, nu in zip(*constants, strict=True))
        return cls(modulus, (first, second), contact)
