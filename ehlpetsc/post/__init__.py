"""Stresses, fatigue damage and its statistics from result files or arrays; needs no PETSc and no MPI."""

from importlib import import_module

_HOMES = {
    "Damage": "fatigue.accumulate",
    "Material": "fatigue.strain_life",
    "WeibullFit": "fatigue.statistics",
    "cycles_to_failure": "fatigue.strain_life",
    "damage": "fatigue.accumulate",
    "equivalent_range": "fatigue.strain_life",
    "out_of_plane": "stresses.half_plane",
    "rainflow": "fatigue.cycles",
    "strain_range": "fatigue.strain_life",
    "stress": "stresses.half_plane",
    "von_mises": "stresses.half_plane",
    "weibull_fit": "fatigue.statistics",
}
__all__ = list(_HOMES)


def __getattr__(name):
    """Import at first use: the command must be able to answer a signal before numba is loaded."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__():
    return sorted({*globals(), *__all__})
