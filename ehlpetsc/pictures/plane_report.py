"""Maps of a point contact or strip for the page of its result, thinned to the resolution of a screen."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ehlpetsc.pictures import plane
from ehlpetsc.pictures.page_values import binned, packed
from ehlpetsc.results.reader import Result

MAX_NODES = 160  # of a map along either side
MAX_VALUES = 2_000_000  # of all maps of a field on a page
LEVELS = 65535  # of a stored value, over the maximum of its field
FILM_ROOM = 10.0  # largest stored film over the upper end of its colours


def frames_on_page(result: Result, window: Sequence[float]) -> int:
    """Number of frames on a page that keeps its size bounded."""
    _, x, y = plane.in_view(result, window)
    widths = (-(-len(axis) // MAX_NODES) for axis in (x, y))
    nodes = np.prod([-(-len(axis) // width) for axis, width in zip((x, y), widths, strict=True)])
    return max(1, MAX_VALUES // int(nodes))


def maps(result: Result, chosen: np.ndarray, window: Sequence[float]) -> dict:
    """Pressure [GPa], film [µm] and contacts of chosen frames, of each block of nodes the extreme."""
    found = [plane.PlaneFrame.of(result, k, window) for k in chosen]
    first = found[0]
    width = tuple(-(-len(axis) // MAX_NODES) for axis in (first.y, first.x))
    thickest = max(frame.thickest for frame in found)
    fields = {
        "pressure": (np.max, [frame.pressure for frame in found]),
        "film": (np.min, [np.minimum(frame.film, FILM_ROOM * thickest) for frame in found]),
    }
    page = {
        "x": packed(binned(first.x, width[1], np.mean)),
        "y": packed(binned(first.y, width[0], np.mean)),
        "contact": packed([blocks(frame.contact, width, np.max) for frame in found], np.uint8),
        "aspect": plane.aspect(result) if np.isfinite(plane.aspect(result)) else None,
        "highest": float(np.percentile([frame.pressure for frame in found], plane.COLOUR_PERCENTILE)),
        "thickest": thickest,
    }
    for name, (reduce, values) in fields.items():
        unit = max(float(np.max(values)), 1e-12) / LEVELS
        levels = [np.rint(blocks(each, width, reduce) / unit) for each in values]
        page[name] = {"unit": unit, "levels": packed(levels, np.uint16)}
    return page


def blocks(values: np.ndarray, width: Sequence[int], reduce: Callable[..., np.ndarray]) -> np.ndarray:
    """Blocks of (rows, columns) of a field of shape (ny, nx) reduced as by `binned`."""
    return binned(binned(values, width[1], reduce).T, width[0], reduce).T
