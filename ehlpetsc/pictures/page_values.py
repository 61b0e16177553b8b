"""Arrays of a page: thinned, then packed as text."""

from __future__ import annotations

import base64
from collections.abc import Callable

import numpy as np


def binned(values: np.ndarray, width: int, reduce: Callable[..., np.ndarray]) -> np.ndarray:
    """Groups of `width` values along the last axis reduced by `reduce(values, axis=-1)`."""
    values = np.asarray(values)
    if width == 1:
        return values
    missing = -values.shape[-1] % width
    padded = np.concatenate([values, np.repeat(values[..., -1:], missing, axis=-1)], axis=-1)
    return reduce(padded.reshape(*values.shape[:-1], -1, width), axis=-1)


def packed(values: np.typing.ArrayLike, kind: type = np.float32) -> str:
    """Numbers as little-endian bytes in base64."""
    raw = np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<"))
    return base64.b64encode(raw).decode("ascii")
