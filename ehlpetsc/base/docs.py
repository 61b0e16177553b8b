"""The command ``ehlpetsc docs``: the pages as one site by Sphinx."""

import os
import subprocess
import sys
import tempfile
import webbrowser
from pathlib import Path

from ehlpetsc.base.command_parser import CommandParser, exit_status
from ehlpetsc.base.environment import missing
from ehlpetsc.base.errors import OutputError

ROOT = Path(__file__).parents[2]  # of a clone
SITE = ROOT / ".github" / "site"
NEEDED = ("sphinx", "myst_parser", "furo")


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    description = "Build the pages as one site, with search and typeset equations, and open it in a browser."
    parser = CommandParser("docs", description, "")
    folder = "build it here, to publish it, and open nothing"
    parser.add_argument("folder", nargs="?", type=Path, metavar="FOLDER", help=folder)
    chosen = parser.parse_args(words)
    return exit_status("docs", lambda: _build(chosen.folder))


def _build(folder: Path | None) -> None:
    if not (SITE / "conf.py").exists():
        raise OutputError("an installed package has no pages: call ./run_mpi.sh docs in a clone")
    if lacks := missing(NEEDED):
        raise OutputError(f"{', '.join(lacks)}: not installed; ./run_mpi.sh docs installs them on Debian")
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    target = (folder or Path(cache, "ehlpetsc", "docs")).absolute()
    with tempfile.TemporaryDirectory() as scratch:
        options = ["-q", "-W", "--keep-going", "-d", scratch, "-c", str(SITE)]
        paths = os.pathsep.join(filter(None, [str(ROOT), *sys.path]))
        command = [sys.executable, "-m", "sphinx", *options, str(ROOT), str(target)]
        status = subprocess.call(command, env=os.environ | {"PYTHONPATH": paths})
    if status:
        raise OutputError(f"{target}: the site was not built")
    print(target / "README.html")
    if folder is None:
        webbrowser.open((target / "README.html").as_uri())
