"""Samples of one surface as its table in the case file describes them."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.surfaces import synthetic
from ehlpetsc.surfaces.filters import high_pass, levelled, low_pass
from ehlpetsc.surfaces.profile_files import read_profile


@dataclass(frozen=True)
class Samples:
    """Heights of one surface, read or made.

    Attributes
    ----------
    X, z : ndarray, shape (n,)
        m; heights positive out of the metal.
    repeats : bool
        Whether the profile continues mirrored beyond its ends, else with height 0.
    ra_unfiltered : float or None
        Ra before `short_cutoff` took the short waves off [m]; None without it.
    """

    X: np.ndarray
    z: np.ndarray
    repeats: bool
    ra_unfiltered: float | None = None


def samples(folder, spec):
    """Samples of one surface: read or made, levelled, both filters, flipped, scaled, in this order.

    Parameters
    ----------
    folder : pathlib.Path
        Of the case file: profile files lie beside it.
    spec : ehlpetsc.case.schema.SurfaceProfile

    Raises
    ------
    ProfileError
    """
    if spec.synthetic is not None:
        X, z, repeats = synthetic.sampled(spec.synthetic)
        return Samples(X, spec.scale * z, repeats)
    X, z = read_profile(folder / spec.file)
    if spec.level:
        z = levelled(X, z)
    if spec.cutoff is not None:
        z = high_pass(X, z, spec.cutoff)
    before = None
    if spec.short_cutoff is not None:
        before = abs(spec.scale) * mean_deviation(z)
        z = low_pass(X, z, spec.short_cutoff)
    if spec.flip:
        X, z = X[-1] + X[0] - X[::-1], z[::-1]
    return Samples(X, spec.scale * z, True, before)


def try_file(folder, table):
    """Read and filter the file of a surface's table that may itself be at fault.

    Parameters
    ----------
    folder : pathlib.Path
    table : dict
        With a text under "file".

    Raises
    ------
    ProfileError
    """
    x, z = read_profile(folder / table["file"])
    for key, pass_filter in (("cutoff", high_pass), ("short_cutoff", low_pass)):
        value = table.get(key)
        if isinstance(value, int | float) and 0 < value <= 1:
            pass_filter(x, z, value)


def mean_deviation(z):
    """Ra: mean deviation of heights from their mean."""
    return float(np.abs(z - z.mean()).mean())
