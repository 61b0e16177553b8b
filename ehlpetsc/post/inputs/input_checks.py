"""Checks of all frames before a computation, and the digest that identifies them."""

import hashlib

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.post.inputs.consistency import Balance

FRAMES_PER_BLOCK = 128  # read at once


def input_digest(loads, surfaces):
    """Check every frame of the loads of `surfaces`; return a digest of all inputs of the damage.

    The digest contains two weighted sums of each frame: a change of the loads that does not change their
    sixteenth digit does not change the damage either.

    Raises
    ------
    PostError
        A value is nan or infinite, a frame does not carry the load, a pressure is negative, ...
    """
    digest = hashlib.sha256()
    profiles = [array for profile in loads.profiles.values() for array in profile or (None,)]
    for array in (loads.case_text.encode(), loads.x, loads.time, loads.step, *profiles):
        digest.update(b"none" if array is None else memoryview(np.ascontiguousarray(array)).cast("B"))
    digest.update(repr((loads.a, loads.p0, loads.speeds, loads.status, surfaces)).encode())
    balance, nodes = Balance(loads), loads.x.size
    weights = np.stack([np.ones(nodes), np.arange(1, nodes + 1) * 0.6180339887498949 % 1], axis=1)
    for first in range(0, loads.time.size, FRAMES_PER_BLOCK):
        last = min(first + FRAMES_PER_BLOCK, loads.time.size)
        for name in loads.needed(surfaces):
            rows = loads.rows(name, first, last)
            with np.errstate(all="ignore"):  # of damaged numbers, which are detected below
                sums = rows @ weights
            _check_finite(loads, name, first, rows, sums)
            _check_rows(balance, name, first, rows, sums[:, 0])
            digest.update(sums)
    return digest.hexdigest()


def _check_rows(balance, name, first, rows, total):
    low, high = rows.min(axis=1), rows.max(axis=1)
    if name == "pressure":
        balance.check_pressure(first, total, low, high)
        return
    if name.startswith("temperature"):
        balance.check_temperature(name, first, low, high)
        return
    balance.check_shear_size(name, first, np.maximum(-low, high))
    if name == "shear_stress_2":
        balance.check_shear_2(first, total)


def _check_finite(loads, name, first, rows, sums):
    if np.isfinite(sums).all():
        return
    wrong = np.argwhere(~np.isfinite(rows))
    if len(wrong):
        frame, node = wrong[0]
        shown = rows[frame, node]
    else:
        frame, node = np.unravel_index(np.abs(rows).argmax(), rows.shape)
        shown = f"{rows[frame, node]:.3g}"
    raise PostError(
        f"dataset {name} is {shown} at frame {first + frame} (t = {loads.time[first + frame]:.6g} s), "
        f"x/a = {loads.x[node] / loads.a:.4g}"
    )
