"""Provenance of a result: versions and the commit of the code."""

from __future__ import annotations

import json
import platform
import subprocess
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from ehlpetsc import __version__

if TYPE_CHECKING:
    from typing import Any


def versions(other_versions: dict[str, str]) -> str:
    """Names and versions in one line: of Python and its libraries, then of `other_versions` (by name)."""
    common = {
        "ehlpetsc": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "h5py": h5py.__version__,
        "hdf5": h5py.version.hdf5_version,
    }
    return ", ".join(f"{name} {version}" for name, version in (common | other_versions).items())


@cache
def git_commit() -> str:
    """Commit of the checkout of the package, ``-dirty`` if changed; "" outside a checkout."""
    top = Path(__file__).resolve().parents[2]
    if not (top / ".git").exists():
        return ""
    command = ["git", "-C", str(top), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return ""  # no git, or a checkout of another user
    return answer.stdout.strip()


def earlier_runs(attrs: dict[str, Any], last_step: int) -> str:
    """JSON list of the configurations of all runs before a restart; `attrs` describes the last one."""
    runs = json.loads(attrs.get("history", "[]"))
    keys = ("case", "petsc_options", "ranks", "versions", "git_commit")
    last_run = {key: attrs[key] for key in keys if key in attrs}
    run = {key: value if isinstance(value, str) else int(value) for key, value in last_run.items()}
    return json.dumps([*runs, {"up_to_step": int(last_step), **run}])
