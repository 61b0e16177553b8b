"""Build the site of the pages: ``ehlpetsc docs`` opens it, ``ehlpetsc docs FOLDER`` is for publishing.

Exit status: 0 built, 2 bad input or a package is missing.
"""

import os
import subprocess
import sys
import tempfile
import webbrowser
from pathlib import Path

from ehlpetsc.command_parser import CommandParser, exit_status
from ehlpetsc.docs.mathjax import mathjax_folder
from ehlpetsc.docs.pages import FRONT, PAGES, ROOT
from ehlpetsc.environment import has
from ehlpetsc.errors import OutputError

DEBIAN_PACKAGES = {"sphinx": "python3-sphinx", "myst_parser": "python3-myst-parser", "furo": "furo"}
SITE_FILE = "objects.inv"  # in every site built by Sphinx


def lacking():
    """Missing Debian packages of the generator.

    Returns
    -------
    list of str
    """
    packages = [package for module, package in DEBIAN_PACKAGES.items() if not has(module)]
    return packages if mathjax_folder() else [*packages, "libjs-mathjax"]


def cache_folder():
    """Folder of the site for reading on this machine.

    Returns
    -------
    pathlib.Path
    """
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home, "ehlpetsc", "docs")


def check(folder):
    """Refuse to build without the pages or the generator, or into a folder with other files.

    Parameters
    ----------
    folder : pathlib.Path

    Raises
    ------
    OutputError
    """
    if not all((ROOT / f"{page}.md").exists() for page in PAGES):
        raise OutputError("an installed package has no pages: call ./run_mpi.sh docs in a clone")
    packages = lacking()
    if packages:
        raise OutputError(f"packages are missing; type: sudo apt-get install {' '.join(packages)}")
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: a file, not a folder for the site")
    if folder.is_dir() and any(folder.iterdir()) and not (folder / SITE_FILE).exists():
        raise OutputError(f"{folder}: holds other files; give a folder that is new or empty")


def build(folder):
    """Build the site; a broken link is an error.

    Parameters
    ----------
    folder : pathlib.Path

    Returns
    -------
    pathlib.Path
        First page of the site.

    Raises
    ------
    OutputError
    """
    with tempfile.TemporaryDirectory() as scratch:
        paths = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
        env = os.environ | {"PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": "1"}
        options = ["-q", "-W", "--keep-going", "-d", scratch, "-c", Path(__file__).parent]
        command = [sys.executable, "-m", "sphinx", *options, ROOT, folder]
        done = subprocess.run(command, env=env, capture_output=True, text=True)
    if done.returncode:
        raise OutputError(f"{folder}: the site was not built\n{done.stderr.strip()}")
    return folder / f"{FRONT}.html"


def main(words):
    """Run the command; returns its exit status."""
    description = "Build the pages as one site, with search and typeset equations, and open it in a browser."
    parser = CommandParser("docs", description)
    folder = "build it here, to publish it, and open nothing"
    parser.add_argument("folder", nargs="?", type=Path, metavar="FOLDER", help=folder)
    chosen = parser.parse_args(words)
    return exit_status("docs", lambda: _run(chosen))


def _run(chosen):
    target = (chosen.folder or cache_folder()).absolute()
    check(target)
    page = build(target)
    print(page)
    if chosen.folder is None:
        webbrowser.open(page.as_uri())
