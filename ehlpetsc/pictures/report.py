"""Self-contained HTML page of one result, its data thinned to the resolution of a screen."""

from __future__ import annotations

import html
import json
import re
from importlib import import_module
from importlib.resources import files
from pathlib import Path

import numpy as np

from ehlpetsc.base.environment import has
from ehlpetsc.base.errors import OutputError
from ehlpetsc.base.quantities import STEP_SCALARS
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames import frame_to_show, travel_of, view
from ehlpetsc.pictures.page_values import binned, packed
from ehlpetsc.pictures.style import hertz_at
from ehlpetsc.results.means import means
from ehlpetsc.results.output_guard import atomic_write
from ehlpetsc.results.post_result import damage_beside
from ehlpetsc.results.reader import Result

MAX_FRAMES, MAX_NODES, MAX_ROWS, MAX_POINTS = 200, 1200, 2000, 2000  # on a page
MIN_CHANGE = 1e-9  # relative change over a run below which a scalar counts as constant
MINIMUM_SCALARS = {"h_min", "film_central", "mean_gap_ratio"}  # of several steps; of others the maximum
FIELDS = {"pressure": (1e-9, np.max), "film_thickness": (1e6, np.min), "contact_pressure": (1e-9, np.max)}
SHOWN_UNITS = {"m": ("µm", 1e6), "Pa": ("GPa", 1e-9), "s": ("µs", 1e6), "N/m": ("N/mm", 1e-3), "1": ("", 1.0)}
HIDDEN_SCALARS = set("step time dt newton retries load wall load_error mass_error".split())
EXTREMES = """h_min p_max film_temperature_max temperature_1_max temperature_2_max load_error
mass_error""".split()  # of the run, in the table at the top


def save_report(result: Result, path: Path) -> None:
    """Write the page."""
    if not has("plotly"):
        raise OutputError("the report is drawn by plotly; type: sudo apt-get install python3-plotly")
    data, page = report_data(result), files("ehlpetsc.pictures").joinpath("page")
    pieces = {
        "style": page.joinpath("report.css").read_text(encoding="utf-8"),
        "script": page.joinpath("report.js").read_text(encoding="utf-8"),
        "title": html.escape(data["title"]),
        "case": html.escape(data["case"]),
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


def report_data(result: Result) -> dict:
    """Data of the page, for JSON; of a point contact or strip maps, and frames of the section at y = 0."""
    line, chosen, of_plane = result, chosen_frames(result, MAX_FRAMES), {}
    if result.y is not None:
        from ehlpetsc.pictures import plane_report

        line, window = result.section(), view([result])
        chosen = chosen_frames(result, min(MAX_FRAMES, plane_report.frames_on_page(result, window)))
        of_plane = {"maps": plane_report.maps(result, chosen, window)}
    return of_plane | {
        "title": str(result.attrs["title"]),
        "facts": facts(result),
        "case": str(result.attrs["case"]),
        "frames": frames(line, chosen),
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
    for name in EXTREMES:
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


def frames(result: Result, chosen: np.ndarray) -> dict:
    """Pressure, film, contacts and Hertz contact of chosen frames in view."""
    x, a = result.x / result.attrs["a"], result.attrs["a"]
    columns = style.in_view(x, view([result]))
    width = -(-len(x[columns]) // MAX_NODES)
    fields = {
        name: packed([binned(factor * result.frame(name, k)[columns], width, reduce) for k in chosen])
        for name, (factor, reduce) in FIELDS.items()
        if name in result
    }
    hertz = [hertz_at(result, k) for k in chosen]
    rows = (result.contacts_at(k, columns) if "in_contact" in result else 0.0 * x[columns] for k in chosen)
    touching = [binned(row, width, np.max) for row in rows]
    return {
        "x": packed(binned(x[columns], width, np.mean)),
        "time": packed(1e6 * result.time[chosen]),
        "step": [int(step) for step in result.step[chosen]],
        "travel": travel_of(result)[chosen].tolist(),
        "first": int(np.searchsorted(chosen, frame_to_show(result))),
        "hertz": [[half_width / a, 1e-9 * p0] for half_width, p0 in hertz],
        "width": width,
        "contact": packed(touching, np.uint8),
        **fields,
    }


def scalars_over_time(result: Result) -> dict:
    """Varying scalars of the steps over time; empty for a steady result."""
    time = result.steps("time")
    if len(time) < 2:
        return {"time": packed([]), "figures": []}
    width, figures = -(-len(time) // MAX_ROWS), []
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
    width = -(-len(post.s) // MAX_POINTS)
    decades = {side: np.log10(np.where(values > 0.0, values, np.nan)) for side, values in post.damage.items()}
    return {
        "s": packed(binned(post.s / post.a, width, np.mean)),
        "depths": post.z.tolist(),
        "surfaces": {
            side: [packed(binned(row, width, np.fmax.reduce)) for row in rows]
            for side, rows in decades.items()
        },
    }
