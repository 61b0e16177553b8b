"""Speed of this machine, as its runs have measured it: time of a unit of work, in the user's cache.

One rate is measured of lines and one of planes, the median of the last runs on one rank; the unit of work is
that of :func:`.cost.work`. This gives up what heat, contacts and other programs on the machine change; it
needs no figures of another machine. Without a run there is no estimate, and a cache that cannot be read or
written is no fault. `tests/unit/test_explain.py` holds it.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
from pathlib import Path

CACHE = "EHLPETSC_CACHE"  # environment variable: folder in place of that of the user
RUNS = 5  # of which the median is taken


def expected_seconds(solver: str, amount: float) -> float | None:
    """Wall clock time of an amount of work of a solver on one rank [s]; None: not measured yet.

    `solver`: key of :data:`.cost.ITERATIONS`.
    """
    rates = sorted(_measured().get(solver, []))
    return amount * rates[(len(rates) - 1) // 2] if rates else None


def keep(solver: str, seconds: float, amount: float) -> None:
    """Keep the rate of a run on one rank."""
    measured, path = _measured(), _path()
    measured[solver] = [*measured.get(solver, []), seconds / amount][-RUNS:]
    temporary = path.with_suffix(f".{os.getpid()}")
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_text(json.dumps(measured))
        temporary.replace(path)


def _path() -> Path:
    home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(os.environ.get(CACHE) or os.path.join(home, "ehlpetsc"), "speed.json")


def _measured() -> dict[str, list[float]]:
    """Rates of the last runs [s]; {} of a cache that is missing or spoiled."""
    try:
        found = json.loads(_path().read_text())
        return {name: [float(rate) for rate in found[name] if 0.0 < rate < math.inf] for name in found}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}
