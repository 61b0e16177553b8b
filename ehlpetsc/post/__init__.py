"""Stresses, fatigue damage and its statistics from result files or arrays; needs no PETSc and no MPI."""

from importlib import import_module

_HOMES = {
    "Criteria": "criteria.laws",
    "Damage": "fatigue.accumulate",
    "Material": "fatigue.strain_life",
    "PlaneDamage": "criteria.critical_plane",
    "WeibullFit": "fatigue.statistics",
    "critical_plane": "criteria.critical_plane",
    "cycles_to_failure": "fatigue.strain_life",
    "damage": "fatigue.accumulate",
    "dang_van": "criteria.dang_van",
    "equivalent_range": "fatigue.strain_life",
    "out_of_plane": "stresses.half_plane",
    "rainflow": "fatigue.cycles",
    "strain_range": "fatigue.strain_life",
    "stress": "stresses.half_plane",
    "von_mises": "stresses.half_plane",
    "weibull_fit": "fatigue.statistics",
}
__all__ = list(_HOMES)


def __getattr__(name: str) -> object:
    """Import at first use, so that the command can handle a signal before numba is loaded."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
