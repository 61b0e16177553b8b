"""Criteria over many histories, of result files and of arrays: their counters and functions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.post.criteria import CRITERIA
from ehlpetsc.post.criteria.critical_plane import FATEMI_SOCIE, SHEAR, SWT, worst_plane
from ehlpetsc.post.criteria.dang_van import utilisation
from ehlpetsc.post.criteria.laws import Criteria, shear_tables, swt_tables
from ehlpetsc.post.criteria.planes import described, planes, planes_and_directions
from ehlpetsc.post.fatigue.accumulate import evaluate
from ehlpetsc.post.fatigue.cycles import RESIDUES, equivalent_points, workspace
from ehlpetsc.post.fatigue.strain_life import DEFAULT_STRAIN, Material

KINDS = {"fatemi-socie": FATEMI_SOCIE, "shear": SHEAR, "swt": SWT}


class PlaneDamage(NamedTuple):
    """Damage of each history on its worst plane, and angles of the plane's normal in degrees.

    `inclination` is from x towards z in the section (90: the plane is parallel to the surface), `tilt` out of
    the section.
    """

    damage: np.ndarray
    inclination: np.ndarray
    tilt: np.ndarray


@compiled(error_model="python", nogil=True)
def _worst_planes(
    kind: int, grid: np.ndarray, histories: tuple, law: tuple, work: tuple, spare: tuple, out: np.ndarray
) -> None:
    stress, lengths = histories
    for p in range(stress.shape[0]):
        out[p] = worst_plane(kind, grid, stress[p, :, : lengths[p]].copy(), law, work, spare)


@compiled(error_model="python", nogil=True)
def _utilisations(histories: tuple, nu: float, residual: float, limits: tuple, out: np.ndarray) -> None:
    stress, lengths = histories
    slope, limit = limits
    points = np.empty((3, stress.shape[2]))
    for p in range(stress.shape[0]):
        history = stress[p, :, : lengths[p]].copy()
        equivalent_points(history, nu, points)
        out[p, 0] = utilisation(history, points[:, : lengths[p]], nu, residual, slope, limit)


class PlaneCounter:
    """Damage on the worst plane of blocks of histories under one criterion."""

    columns = ("damage", "inclination", "tilt")

    def __init__(
        self, criterion: str, material: Material, constants: Criteria, residue: str, strain: str, samples: int
    ) -> None:
        self.kind = KINDS[criterion]
        self.grid = planes() if self.kind == SWT else planes_and_directions()
        self.tables = (swt_tables if self.kind == SWT else shear_tables)(material, strain)
        self.head = (material.poisson_ratio, residue == "closed", constants.sensitivity(material))
        self.work = (*workspace(samples), np.empty(samples), np.empty(samples))
        self.spare = np.empty((3, samples)), np.empty(samples, np.int64)

    def __call__(
        self, stress: np.ndarray, lengths: np.ndarray, out: np.ndarray, residual: float = 0.0
    ) -> None:
        """Stress (points, 3, samples), lengths (points,) -> out (points, 3): as in PlaneDamage."""
        nu, closed, sensitivity = self.head
        law = (nu, float(residual), closed, sensitivity, *self.tables)
        worst = np.empty((len(stress), 3))
        stress = np.ascontiguousarray(stress, float)  # one compiled version for files and arrays
        _worst_planes(self.kind, self.grid, (stress, lengths), law, self.work, self.spare, worst)
        out[:, 0] = worst[:, 0]
        out[:, 1], out[:, 2] = described(worst[:, 1], worst[:, 2])


class LimitCounter:
    """Dang Van's utilisation of blocks of histories."""

    columns = ("utilisation",)

    def __init__(self, poisson_ratio: float, constants: Criteria) -> None:
        self.nu = poisson_ratio
        self.limits = constants.hydrostatic_slope, constants.torsion_limit

    def __call__(
        self, stress: np.ndarray, lengths: np.ndarray, out: np.ndarray, residual: float = 0.0
    ) -> None:
        """Stress (points, 3, samples), lengths (points,) -> out (points, 1)."""
        stress = np.ascontiguousarray(stress, float)
        _utilisations((stress, lengths), self.nu, float(residual), self.limits, out)


def columns_of(criterion: str) -> tuple[str, ...]:
    """Names of the results of a criterion for each history."""
    return (LimitCounter if criterion == "dang-van" else PlaneCounter).columns


def counter_of(
    criterion: str, material: Material, constants: Criteria, residue: str, strain: str, samples: int
) -> PlaneCounter | LimitCounter:
    """Counter of a criterion; ValueError for an unknown name."""
    if criterion not in CRITERIA:
        raise ValueError(f"criterion = {criterion!r}: must be one of {', '.join(CRITERIA)}")
    if residue not in RESIDUES:
        raise ValueError(f"residue = {residue!r}: must be one of {', '.join(RESIDUES)}")
    if criterion == "dang-van":
        return LimitCounter(material.poisson_ratio, constants)
    return PlaneCounter(criterion, material, constants, residue, strain, samples)


def critical_plane(
    sx: np.ndarray,
    sz: np.ndarray,
    txz: np.ndarray,
    material: Material,
    criterion: str = "fatemi-socie",
    constants: Criteria | None = None,
    residue: str = "closed",
    strain: str = DEFAULT_STRAIN,
    residual_stress: float = 0.0,
) -> PlaneDamage:
    """Damage of one pass of each history on its worst plane, planes in three dimensions.

    Parameters
    ----------
    sx, sz, txz
        Stress histories [Pa], shape (..., samples); sigma_y follows by plane strain.
    criterion
        "fatemi-socie", "shear" or "swt"; equations and sources: :mod:`ehlpetsc.post.criteria.laws`.
    residue, strain
        See :func:`ehlpetsc.post.damage`.
    residual_stress
        Residual stress along the surface, equal in x and y, zero in z [Pa]; adds to the normal stress of a
        plane.
    """
    if criterion not in KINDS:
        raise ValueError(f"criterion = {criterion!r}: must be one of {', '.join(KINDS)}")

    def make(samples: int) -> PlaneCounter | LimitCounter:
        return counter_of(criterion, material, constants or Criteria(), residue, strain, samples)

    return PlaneDamage(*evaluate(sx, sz, txz, make, residual_stress))


def dang_van(
    sx: np.ndarray,
    sz: np.ndarray,
    txz: np.ndarray,
    poisson_ratio: float,
    constants: Criteria | None = None,
    residual_stress: float = 0.0,
) -> float | np.ndarray:
    """Dang Van's utilisation U of the fatigue limit by each history; no crack for U <= 1, safety 1/U.

    Parameters
    ----------
    sx, sz, txz
        Stress histories [Pa], shape (..., samples); sigma_y follows by plane strain.
    constants
        With the two fatigue limits.
    residual_stress
        Residual stress along the surface, equal in x and y [Pa]; adds to the hydrostatic stress.
    """
    constants = constants or Criteria()
    return evaluate(sx, sz, txz, lambda samples: LimitCounter(poisson_ratio, constants), residual_stress)[0]
