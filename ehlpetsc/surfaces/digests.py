"""Comparison of the digests of surface files; free of the keys, which load the laws and numba."""

from __future__ import annotations


def changed_files(before: dict[str, str], now: dict[str, str]) -> str:
    """Keys of the files whose digests differ, joined by "and"; "": none. Files in one alone do not count."""
    return " and ".join(key for key in now if before.get(key, now[key]) != now[key])
