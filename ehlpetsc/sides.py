"""Names of the surfaces: 1 and 2. Cases, results and scripts of earlier versions have fast and slow."""

import re

SIDES = ("1", "2")
FORMER = {"fast": "1", "slow": "2"}
_CURRENT = {side: former for former, side in FORMER.items()}
_ANY_FORMER = re.compile(r"(?<![A-Za-z])(fast|slow)(?![A-Za-z])")
_ANY_CURRENT = re.compile(r"(?<![A-Za-z0-9])([12])(?![A-Za-z0-9])")


def current_name(name):
    """Name of today of a quantity or group: ``shear_stress_1`` of ``shear_stress_fast``."""
    return _ANY_FORMER.sub(lambda found: FORMER[found[0]], name)


def former_name(name):
    """Former name of a quantity or group: ``surface/fast/z`` of ``surface/1/z``."""
    return _ANY_CURRENT.sub(lambda found: _CURRENT[found[0]], name)


def stored_name(group, name):
    """The name under which a group of a file, or a table, has a quantity: today's, else a former one."""
    return next((known for known in (name, current_name(name), former_name(name)) if known in group), name)
