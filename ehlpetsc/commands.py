"""The program ``ehlpetsc`` and its subcommands, and the commands of earlier releases that pip installs.

``ehlpetsc CASE.toml`` runs a case, ``ehlpetsc plot RESULT.h5`` draws, and so on: `SUBCOMMANDS`. The names
``ehlpetsc-post``, ``-plot`` and ``-compare`` and ``python3 -m ehlpetsc.post`` ... remain.
``run_mpi.sh`` starts a command by ``python3 -m ehlpetsc.commands NAME ...``.
"""

import importlib
import os
import shlex
import sys
from functools import partial

from ehlpetsc.environment import NUMERICS, missing

PLOTTING = (*NUMERICS, "matplotlib")
SUBCOMMANDS = {  # name: module, function, packages needed, description
    "plot": ("ehlpetsc.pictures.command", "main", PLOTTING, "pictures of results, of a series or of a case"),
    "post": ("ehlpetsc.post.command", "command", NUMERICS, "subsurface stresses, fatigue damage, statistics"),
    "summary": ("ehlpetsc.analysis.summary", "main", NUMERICS, "means, percentiles and extremes as CSV"),
    "compare": ("ehlpetsc.compare", "main", NUMERICS, "two results field by field"),
    "gears": (
        "ehlpetsc.gears.command",
        "main",
        PLOTTING,
        "path of contact of spur gears, and runs along it",
    ),
    "life": ("ehlpetsc.life.command", "main", PLOTTING, "wear against fatigue over many passes"),
    "ensemble": ("ehlpetsc.analysis.ensemble", "main", NUMERICS, "means over runs of several seeds"),
    "docs": ("ehlpetsc.docs.__main__", "main", (), "these pages as one site, opened in a browser"),
}
OF_A_CASE = {  # options of a run: arguments and description
    "explain": ("CASE.toml", "what a run would do"),
    "keys": ("[TABLE or TABLE.KEY]", "keys of a case: meaning, unit, range, default"),
    "template": ("", "a case file to begin with"),
}
COMPLETION = """_ehlpetsc() {{
    local words="{words}"
    if [ "$COMP_CWORD" = 1 ]; then
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$2"; compgen -f -X '!*.toml' -- "$2")
    fi
}}
complete -o default -F _ehlpetsc ehlpetsc
"""


def solver():
    """``ehlpetsc CASE.toml [options]``: run a case; or a subcommand."""
    return dispatch(lambda: importlib.import_module("ehlpetsc.__main__").run_guarded(sys.argv))


def dispatch(run):
    """Start the subcommand in the first argument, otherwise run a case; returns the exit status."""
    first = sys.argv[1] if len(sys.argv) > 1 else ""
    if first in OF_A_CASE:
        if {"-h", "--help"} & set(sys.argv[2:]):
            arguments, description = OF_A_CASE[first]
            print(f"usage: ehlpetsc {' '.join(filter(None, (first, arguments)))}\n\n{description}")
            return 0
        sys.argv[1] = f"--{first}"
    elif first == "run":
        del sys.argv[1]
    elif first == "python":
        return _python(sys.argv[2:])
    elif first == "completion":
        print(COMPLETION.format(words=" ".join(["run", *SUBCOMMANDS, *OF_A_CASE, "python"])), end="")
        return 0
    elif first in SUBCOMMANDS:
        program = "ehlpetsc" if os.path.basename(sys.argv[0]) == "ehlpetsc" else "python3 -m ehlpetsc"
        sys.argv = [f"{program} {first}", *sys.argv[2:]]
        return _start(first)
    return run()


def _python(words):
    """Run a script, or Python itself, with ehlpetsc on the path."""
    from ehlpetsc.environment import prepare

    prepare()
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    os.execv(sys.executable, [sys.executable, *words])


def _start(name):
    module, function, needed, _ = SUBCOMMANDS[name]
    lacks = missing(needed)
    if lacks:
        print(
            f"ehlpetsc: this Python ({sys.executable}) does not have {', '.join(lacks)}\n"
            f"type: {shlex.join([sys.executable, '-m', 'pip', 'install', *lacks])}",
            file=sys.stderr,
        )
        sys.exit(2)
    return getattr(importlib.import_module(module), function)()


post, plot, compare = (partial(_start, name) for name in ("post", "plot", "compare"))
BY_NAME = {
    "ehlpetsc": solver,
    "ehlpetsc-post": post,
    "ehlpetsc-plot": plot,
    "ehlpetsc-compare": compare,
}

if __name__ == "__main__":
    sys.argv.pop(0)
    sys.exit(BY_NAME[sys.argv[0]]())
