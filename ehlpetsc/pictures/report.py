"""Self-contained HTML page of one result, its data thinned to the resolution of a screen."""

from __future__ import annotations

import base64
import html
import json
import re
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.resources import files
from pathlib import Path

import numpy as np

from ehlpetsc.base.environment import has
from ehlpetsc.base.errors import OutputError
from ehlpetsc.base.quantities import STEP_SCALARS
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames.choice import Choice, frame_to_show, travel_of, view
from ehlpetsc.pictures.frames.data import MOSTLY, SHOWN_UNITS, Frame, aspect, common, contact_word, in_view
from ehlpetsc.results.means import means
from ehlpetsc.results.output_guard import atomic_write
from ehlpetsc.results.post_result import damage_beside
from ehlpetsc.results.reader import Result

PAGE_FRAMES, PAGE_NODES, PAGE_ROWS, PAGE_POINTS = 200, 1200, 2000, 2000  # on a page
MIN_CHANGE = 1e-9  # relative change over a run below which a scalar counts as constant
MINIMUM_SCALARS = {"h_min", "film_central", "mean_gap_ratio"}  # of several steps; of others the maximum
HIDDEN_SCALARS = set("step time dt newton retries load wall load_error mass_error".split())
AT_TOP = """h_min p_max film_temperature_max temperature_1_max temperature_2_max load_error
mass_error""".split()  # of the run, in the table at the top
MAX_MAP_NODES = 160  # of a map along either side
MAX_VALUES = 2_000_000  # of all maps of a field on a page
LEVELS = 65535  # of a stored value, over the maximum of its field
MAX_STORED_FILM = 10.0  # largest stored film over the upper end of its axis


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


def frames_on_page(result: Result, window: Sequence[float]) -> int:
    """Number of frames on a page that keeps its size bounded."""
    _, x, y = in_view(result, window)
    widths = (-(-len(axis) // MAX_MAP_NODES) for axis in (x, y))
    nodes = np.prod([-(-len(axis) // width) for axis, width in zip((x, y), widths, strict=True)])
    return max(1, MAX_VALUES // int(nodes))


def plane_maps(result: Result, shown: list[Frame]) -> dict:
    """Pressure [GPa], film or another field and contacts of frames, of each block of nodes the extreme."""
    first, limits = shown[0], common(frame.limits for frame in shown)
    width = tuple(-(-len(axis) // MAX_MAP_NODES) for axis in (first.y, first.x))
    page = {
        "x": packed(binned(first.x, width[1], np.mean)),
        "y": packed(binned(first.y, width[0], np.mean)),
        "contact": packed([blocks(is_marked(frame), width, np.max) for frame in shown], np.uint8),
        "aspect": aspect(result) if np.isfinite(aspect(result)) else None,
        "highest": limits.brightest,
        "ends": limits[2:],
    }
    highest = MAX_STORED_FILM * limits.high if first.is_film else np.inf
    fields = {
        "pressure": (np.max, [frame.pressure for frame in shown]),
        "values": (reduction(first), [np.minimum(frame.values, highest) for frame in shown]),
    }
    for name, (reduce, values) in fields.items():
        low = min(0.0, float(np.nanmin(values)))
        unit = max(float(np.nanmax(values)) - low, 1e-12) / LEVELS
        levels = [np.rint((blocks(np.nan_to_num(each), width, reduce) - low) / unit) for each in values]
        page[name] = {"low": low, "unit": unit, "levels": packed(levels, np.uint16)}
    return page


def is_marked(frame: Frame) -> np.ndarray:
    """Nodes that are marked as in contact."""
    return frame.share > MOSTLY


def reduction(frame: Frame) -> Callable[..., np.ndarray]:
    """Extreme of several nodes that a page shows: of film the minimum, of other fields the maximum."""
    return np.min if frame.is_film else np.max


def blocks(values: np.ndarray, width: Sequence[int], reduce: Callable[..., np.ndarray]) -> np.ndarray:
    """Blocks of (rows, columns) of a field of shape (ny, nx) reduced as by `binned`."""
    return binned(binned(values, width[1], reduce).T, width[0], reduce).T


def save_report(result: Result, path: Path, field: str | None = None) -> None:
    """Write the page, with a stored field in the place of the film."""
    if not has("plotly"):
        raise OutputError("the report is drawn by plotly; type: sudo apt-get install python3-plotly")
    data, page = report_data(result, field), files("ehlpetsc.pictures").joinpath("page")
    pieces = {
        "style": page.joinpath("report.css").read_text(encoding="utf-8"),
        "script": page.joinpath("report.js").read_text(encoding="utf-8"),
        "title": html.escape(data["title"]),
        "case": html.escape(data["case"]),
        "word": html.escape(data["frames"]["word"]),
        "facts": "".join(
            f"<tr><th>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>"
            for name, value in data["facts"]
        ),
        # only "<" can end a script element
        "data": json.dumps(data, allow_nan=False).replace("<", "\\u003c"),
        "plotly": import_module("plotly.offline").get_plotlyjs(),
    }
    template = page.joinpath("report.html").read_text(encoding="utf-8")
    # in one go: a title may hold such words too
    atomic_write(path, re.sub(r"\{\{(\w+)\}\}", lambda word: pieces[word[1]], template).encode())


def report_data(result: Result, field: str | None = None) -> dict:
    """Data of the page, for JSON; of a point contact or strip maps, and frames of the section at y = 0."""
    line, chosen, maps, window = result, chosen_frames(result, PAGE_FRAMES), {}, view([result])
    if result.y is not None:
        line = result.section()
        chosen = chosen_frames(result, min(PAGE_FRAMES, frames_on_page(result, window)))
        maps = {"maps": plane_maps(result, [Frame.of(result, k, window, field) for k in chosen])}
    shown = [Frame.of(line, k, window, field) for k in chosen]
    return maps | {
        "flow": Choice([result], [chosen[0]], window).flow,
        "title": str(result.attrs["title"]),
        "facts": facts(result),
        "case": str(result.attrs["case"]),
        "frames": frames(line, chosen, shown),
        "steps": scalars_over_time(result),
        "damage": damage(result),
    }


def facts(result: Result) -> list[tuple[str, str]]:
    """Names and values of the table at the top; means as of `ehlpetsc.results.means`."""
    nodes = len(result.x) if result.y is None else f"{len(result.x)} x {len(result.y)}"
    rows = [
        ("ended as", str(result.attrs["status"])),
        ("contact", f"{result.case.contact.model} contact, {style.conditions([result])}"),
        ("nodes, steps", f"{nodes}, {len(result.steps('time')) - 1}"),
    ]
    for name in AT_TOP:
        if name in result.scalars and np.isfinite(values := result.steps(name)).any():
            extreme = np.nanmin(values) if name in MINIMUM_SCALARS else np.nanmax(values)
            rows.append((STEP_SCALARS[name].long_name, _with_unit(result, name, extreme)))
    for name, mean in means(result).items():
        rows.append((f"{name.replace('_', ' ')}, mean", _with_unit(result, name, mean)))
    return rows + [("limit", line) for line in str(result.attrs.get("limits", "")).strip().splitlines()]


def _shown_unit(result: Result, name: str) -> tuple[str, float]:
    """Unit in which a scalar is shown, and the factor to it."""
    unit = result.unit(f"steps/{name}")
    return SHOWN_UNITS.get(unit, (unit, 1.0))


def _with_unit(result: Result, name: str, value: float) -> str:
    unit, factor = _shown_unit(result, name)
    return f"{factor * value:.4g} {unit}".strip()


def chosen_frames(result: Result, most: int) -> np.ndarray:
    """Indices of at most so many frames for the page, and of the one it shows first."""
    return np.unique(np.append(style.spread(len(result.time), most), frame_to_show(result)))


def frames(result: Result, chosen: np.ndarray, shown: list[Frame]) -> dict:
    """Pressure, film or another field, contacts and Hertz contact of chosen frames in view."""
    first, width = shown[0], -(-len(shown[0].x) // PAGE_NODES)
    fields = {"pressure": np.max, "values": reduction(first)}
    if "contact_pressure" in result:
        fields["solids"] = np.max
    return {
        "x": packed(binned(first.x, width, np.mean)),
        "time": packed(1e6 * result.time[chosen]),
        "step": [int(step) for step in result.step[chosen]],
        "travel": travel_of(result)[chosen].tolist(),
        "first": int(np.searchsorted(chosen, frame_to_show(result))),
        "hertz": [[frame.half_widths[0], frame.p0] for frame in shown],
        "width": width,
        "word": first.word,
        "label": first.label.replace("\n", " "),
        "is_film": first.is_film,
        "ends": common(frame.limits for frame in shown)[2:],
        "contact": packed([binned(is_marked(frame), width, np.max) for frame in shown], np.uint8),
        "contact_word": contact_word(result),
    } | {
        name: packed([binned(getattr(frame, name), width, reduce) for frame in shown])
        for name, reduce in fields.items()
    }


def scalars_over_time(result: Result) -> dict:
    """Varying scalars of the steps over time; empty for a steady result."""
    time = result.steps("time")
    if len(time) < 2:
        return {"time": packed([]), "figures": []}
    width, figures = -(-len(time) // PAGE_ROWS), []
    for name in (name for name in STEP_SCALARS if name in result.scalars and name not in HIDDEN_SCALARS):
        values = result.steps(name).astype(float)[1:]
        finite = values[np.isfinite(values)]
        if not finite.size or np.ptp(finite) <= MIN_CHANGE * np.abs(finite).max():
            continue
        unit, factor = _shown_unit(result, name)
        reduce = np.fmin.reduce if name in MINIMUM_SCALARS else np.fmax.reduce
        label = STEP_SCALARS[name].long_name + (f" [{unit}]" if unit else "")
        figures.append({"name": label, "y": packed(binned(factor * values, width, reduce))})
    return {"time": packed(binned(1e6 * time[1:], width, np.mean)), "figures": figures, "width": width}


def damage(result: Result) -> dict | None:
    """Damage below the surfaces from RESULT.post.h5; None without this file."""
    post = damage_beside(result)
    if post is None:
        return None
    width = -(-len(post.s) // PAGE_POINTS)
    decades = {side: np.log10(np.where(values > 0.0, values, np.nan)) for side, values in post.damage.items()}
    return {
        "s": packed(binned(post.s / post.a, width, np.mean)),
        "depths": post.z.tolist(),
        "surfaces": {
            side: [packed(binned(row, width, np.fmax.reduce)) for row in rows]
            for side, rows in decades.items()
        },
    }
