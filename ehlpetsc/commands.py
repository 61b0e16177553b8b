"""The commands that pip installs: ``ehlpetsc``, ``ehlpetsc-post``, ``-plot``, ``-compare`` and ``-study``.

``python3 -m ehlpetsc.commands NAME ...`` is the one of that name: so ``run_mpi.sh`` starts them.
"""

import importlib
import shlex
import sys

from ehlpetsc.environment import NUMERICS, missing


def solver():
    """``ehlpetsc CASE.toml [options]``: run a case."""
    return _command("ehlpetsc.__main__").guarded(sys.argv)


def post():
    """``ehlpetsc-post RESULT.h5 ...``: damage, statistics and pictures."""
    return _command("ehlpetsc.post.command", NUMERICS).command()


def plot():
    """``ehlpetsc-plot RESULT.h5 ...``: pictures."""
    return _command("ehlpetsc.plot.__main__", (*NUMERICS, "matplotlib")).main()


def compare():
    """``ehlpetsc-compare A.h5 B.h5``: two results field by field."""
    return _command("ehlpetsc.compare", NUMERICS).main()


def study():
    """``ehlpetsc-study CASE.toml``: accuracy, speed, robustness."""
    return _command("ehlpetsc.study.__main__", (*NUMERICS, "matplotlib")).main(sys.argv[1:])


def _command(module, needed=()):
    """The module of a command, once what it needs is known to be there (else exit 2)."""
    lacks = missing(needed)
    if lacks:
        print(
            f"ehlpetsc: this Python ({sys.executable}) does not have {', '.join(lacks)}\n"
            f"type: {shlex.join([sys.executable, '-m', 'pip', 'install', *lacks])}",
            file=sys.stderr,
        )
        sys.exit(2)
    return importlib.import_module(module)


BY_NAME = {
    "ehlpetsc": solver,
    "ehlpetsc-post": post,
    "ehlpetsc-plot": plot,
    "ehlpetsc-compare": compare,
    "ehlpetsc-study": study,
}

if __name__ == "__main__":
    sys.argv.pop(0)
    sys.exit(BY_NAME[sys.argv[0]]())
