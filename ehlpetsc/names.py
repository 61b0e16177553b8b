"""Names of surfaces and quantities, and former names, still read in cases, results and scripts."""

import re

SIDES = ("1", "2")
FORMER = {"fast": "1", "slow": "2"}
_FORMER = FORMER | {"molecular_films": "nodes_below_1nm"}
_CURRENT = {current: former for former, current in _FORMER.items()}
_ANY_FORMER = re.compile(rf"(?<![A-Za-z])({'|'.join(_FORMER)})(?![A-Za-z])")
_ANY_CURRENT = re.compile(rf"(?<![A-Za-z0-9])({'|'.join(_CURRENT)})(?![A-Za-z0-9])")


def current_name(name):
    """Current name of a quantity or group: ``shear_stress_1`` of ``shear_stress_fast``."""
    return _ANY_FORMER.sub(lambda match: _FORMER[match[0]], name)


def former_name(name):
    """Former name of a quantity or group: ``surface/fast/z`` of ``surface/1/z``."""
    return _ANY_CURRENT.sub(lambda match: _CURRENT[match[0]], name)


def stored_name(group, name):
    """Name under which a group of a file, or a table, has a quantity: the current or the former one."""
    return next((alias for alias in (name, current_name(name), former_name(name)) if alias in group), name)
