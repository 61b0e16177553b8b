"""Materials, constants of the criteria and depths from the case of a result."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.materials import fatigue_constants, named_steels
from ehlpetsc.post.criteria.laws import Criteria
from ehlpetsc.post.fatigue.strain_life import Material

DEPTHS = (0.0, 0.01, 0.03, 0.05, 0.1, 0.2, 0.5)  # z/a, default: the depths of the paper and some between


class Settings(NamedTuple):
    """Depths z/a, material of each surface, constants of the criteria, residual stress (z/a, Pa)."""

    depths: tuple
    material_1: Material
    material_2: Material
    criteria: Criteria = Criteria()
    residual_stress: tuple = ()

    def material(self, surface):
        """Material of surface "1" or "2"."""
        return {"1": self.material_1, "2": self.material_2}[surface]

    def residual(self, depth):
        """Residual stress along the surface at a depth z/a, Pa, linearly interpolated."""
        if not self.residual_stress:
            return 0.0
        depths, values = zip(*self.residual_stress, strict=True)
        return float(np.interp(depth, depths, values))


def read_settings(case):
    """Settings of a case.

    Parameters
    ----------
    case : ehlpetsc.case.loading.Case

    Raises
    ------
    PostError
        The fatigue limits contradict each other.
    """
    post, contact = case.post, case.contact

    def set_in_case(constants):
        values = {name: getattr(post, name, None) for name in constants}
        return {name: value for name, value in values.items() if value is not None}

    materials = [
        Material(modulus, ratio, **fatigue_constants(steel, post.as_dict()))
        for modulus, ratio, steel in zip(
            contact.youngs_modulus, contact.poisson_ratio, named_steels(contact.material), strict=True
        )
    ]
    try:
        criteria = Criteria(**set_in_case(Criteria.__dataclass_fields__))
    except ValueError as fault:
        raise PostError(f"post.{fault}") from None
    depths = tuple(sorted(set(post.depths or DEPTHS)))
    return Settings(depths, *materials, criteria, tuple(map(tuple, post.residual_stress or ())))
