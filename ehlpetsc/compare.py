"""The command ``ehlpetsc compare A.h5 B.h5``: see :mod:`ehlpetsc.analysis.compare`."""

import sys

from ehlpetsc.analysis.compare import main

if __name__ == "__main__":
    sys.exit(main())
