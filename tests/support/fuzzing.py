"""Number of draws, and the checks of a drawn case up to its first solve."""

import os
import tomllib

import numpy as np
import pytest

from ehlpetsc.base.errors import CaseError
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.explain import explain
from ehlpetsc.surfaces.roughness import Roughness

SEED = int(os.environ.get("EHL_FUZZ_SEED", "1"))
LARGE = 5000  # nodes of a mesh beyond which nothing is worked out on it


def draws(usual):
    """EHL_FUZZ of the environment, or the usual number."""
    return int(os.environ.get("EHL_FUZZ", usual))


def faults_of(load, about):
    """Fault messages of a case, none if a run can use it. Any other exception fails the test."""
    try:
        _used(load())
    except CaseError as error:
        assert error.faults and not any("\n" in line for line in error.faults)
        return error.faults
    except Exception as error:
        pytest.fail(f"{type(error).__name__}: {error}\n{about()}")
    return []


def _used(case):
    """Use a case as a run does before its first solve: no accepted value may raise."""
    scales = Scales.of(case)
    if case.mesh.nodes < LARGE:
        rough = Roughness.of(case, scales)
        for cell in (None, scales.dx) if rough else ():
            assert np.isfinite(rough.phi(scales.x * scales.a, 0.5 * (scales.duration or 0.0), cell)).all()
        assert explain(case)
    tomllib.loads(case.text)
