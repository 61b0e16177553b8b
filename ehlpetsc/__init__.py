"""Transient mixed lubrication and contact of rough line contacts on PETSc."""

import sys

__version__ = "0.1.0"

if sys.argv[0] == "-m":  # a command of this package, about to be imported: what it needs may not be there
    from ehlpetsc.environment import require_numerics

    require_numerics()
