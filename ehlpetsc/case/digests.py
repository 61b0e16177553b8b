"""Digests of the surface files of a case, which may change between the parts of a run."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from ehlpetsc.base.errors import CaseError

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case


def file_digests(case: Case) -> dict[str, str]:
    """SHA-256 of the present surface files of a case by their keys; "" of a missing one."""
    digests = {}
    for side in ("1", "2"):
        table = case.surface.side(side)
        if table and table.file:
            try:
                with open(case.path.parent / table.file, "rb") as file:
                    digests[f"surface.{side}.file"] = hashlib.file_digest(file, "sha256").hexdigest()
            except OSError:
                digests[f"surface.{side}.file"] = ""
    return digests


def changed_files(before: dict[str, str], now: dict[str, str]) -> str:
    """Keys of the files whose digests differ, joined by "and"; "": none. Files in one alone do not count."""
    return " and ".join(key for key in now if before.get(key, now[key]) != now[key])


def check_unchanged(case: Case) -> None:
    """Refuse a case whose surface files are no longer as they were read: CaseError."""
    if changed := changed_files(case.digests, file_digests(case)):
        raise CaseError([f"{case.path}: {changed}: changed since the case was read; load the case again"])
