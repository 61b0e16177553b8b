"""Transient mixed lubrication and contact of rough line contacts on PETSc.

``load`` a case, ``solve`` it, or iterate over the accepted states of a ``Simulation``; ``read_result`` opens
a file. ``gears`` computes paths of contact of gears, ``post`` stresses and damage. They are imported at first
use.
"""

import importlib
import sys

if sys.argv[:1] == ["-m"] and "ehlpetsc" in sys.orig_argv or "".join(sys.argv[:1]).endswith("/ehlpetsc"):
    import signal  # of the program alone: until `main` handles Ctrl-C it ends the process without a traceback

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)

from ehlpetsc.base.environment import need_solver
from ehlpetsc.base.version import __version__ as __version__

_HOMES = {
    "load": "ehlpetsc.case.loading",
    "members": "ehlpetsc.case.loading",
    "solve": "ehlpetsc.api",
    "Simulation": "ehlpetsc.run.simulation",
    "read_result": "ehlpetsc.api",
    "Result": "ehlpetsc.api",
    "gears": "ehlpetsc.gears",
    "post": "ehlpetsc.post",
    "CaseError": "ehlpetsc.base.errors",
    "NotConverged": "ehlpetsc.base.errors",
    "OutputError": "ehlpetsc.base.errors",
    "UsageError": "ehlpetsc.base.errors",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'ehlpetsc' has no attribute {name!r}")
    if _HOMES[name].startswith("ehlpetsc.run."):
        need_solver()
    home = importlib.import_module(_HOMES[name])
    return getattr(home, name, home)


def __dir__() -> list[str]:
    return [*globals(), *_HOMES]
