"""Self-contained HTML page of one result, its data thinned to the resolution of a screen."""

from __future__ import annotations

import base64
import html
import json
import re
from importlib import import_module
from importlib.resources import files
from pathlib import Path

import numpy as np

from ehlpetsc.base.environment import has
from ehlpetsc.base.errors import OutputError
from ehlpetsc.effects.quantities import STEP_SCALARS
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames import frame_to_show, travel_of, view
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
MEANS = {  # over the time in which both surfaces fill the contact: label, factor, unit
    "friction_coefficient": ("mean friction coefficient", 1.0, ""),
    "film_central": ("mean central film", 1e6, " µm"),
    "lambda_ratio": ("lambda ratio", 1.0, ""),
    "mean_gap_ratio": ("mean gap ratio", 1.0, ""),
    "contact_share": ("mean share of the load on the solids", 100.0, " %"),
}
TEMPERATURES = ("film_temperature_max", "temperature_1_max", "temperature_2_max")


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
    """Data of the page, for JSON."""
    return {
        "title": str(result.attrs["title"]),
        "facts": facts(result),
        "case": str(result.attrs["case"]),
        "frames": frames(result),
        "steps": scalars_over_time(result),
        "damage": damage(result),
    }


def facts(result: Result) -> list[tuple[str, str]]:
    """Names and values of the table at the top."""
    attrs, steps = result.attrs, result.steps
    rows = [
        ("ended as", str(attrs.get("status", "unknown"))),
        ("contact", f"{result.case.contact.model} contact, {style.conditions([result])}"),
        ("nodes, steps", f"{len(result.x)}, {len(steps('time')) - 1}"),
        ("minimum film", f"{1e6 * np.nanmin(steps('h_min')):.4g} µm"),
        ("maximum pressure", f"{1e-9 * np.nanmax(steps('p_max')):.4g} GPa"),
    ]
    found = means(result)
    for name, (label, factor, unit) in MEANS.items():
        if name in found:
            rows.append((label, f"{factor * found[name]:.4g}{unit}"))
    if TEMPERATURES[0] in result.scalars:
        values = ", ".join(f"{np.nanmax(steps(name)) - 273.15:.1f}" for name in TEMPERATURES)
        rows.append(("maximum temperature of film, surface 1, surface 2", f"{values} °C"))
    for name, words in (("load_error", "load"), ("mass_error", "oil balance")):
        if np.isfinite(steps(name)).any():
            rows.append((f"maximum error of the {words}", f"{np.nanmax(steps(name)):.2g}"))
    return rows + [("limit", line) for line in str(attrs.get("limits", "")).strip().splitlines()]


def frames(result: Result) -> dict:
    """Pressure, film, contacts and Hertz contact of stored frames in view."""
    x, a = result.x / result.attrs["a"], result.attrs["a"]
    columns = style.in_view(x, view([result]))
    width = -(-len(x[columns]) // MAX_NODES)
    last, shown = len(result.time) - 1, frame_to_show(result)
    spread = np.linspace(0, last, min(last + 1, MAX_FRAMES)).round().astype(int)
    chosen = np.unique(np.append(spread, shown))
    fields = {
        name: _packed([binned(factor * result.frame(name, k)[columns], width, reduce) for k in chosen])
        for name, (factor, reduce) in FIELDS.items()
        if name in result
    }
    hertz = [hertz_at(result, k) for k in chosen]
    rows = (result.contacts_at(k, columns) if "in_contact" in result else 0.0 * x[columns] for k in chosen)
    touching = [binned(row, width, np.max) for row in rows]
    return {
        "x": _packed(binned(x[columns], width, np.mean)),
        "time": _packed(1e6 * result.time[chosen]),
        "step": [int(step) for step in result.step[chosen]],
        "travel": travel_of(result)[chosen].tolist(),
        "first": int(np.searchsorted(chosen, shown)),
        "hertz": [[half_width / a, 1e-9 * p0] for half_width, p0 in hertz],
        "width": width,
        "contact": _packed(touching, np.uint8),
        **fields,
    }


def scalars_over_time(result: Result) -> dict:
    """Varying scalars of the steps over time; empty for a steady result."""
    time = result.steps("time")
    if len(time) < 2:
        return {"time": _packed([]), "figures": []}
    width, figures = -(-len(time) // MAX_ROWS), []
    for name in (name for name in STEP_SCALARS if name in result.scalars and name not in HIDDEN_SCALARS):
        values = result.steps(name).astype(float)[1:]
        finite = values[np.isfinite(values)]
        if not finite.size or np.ptp(finite) <= MIN_CHANGE * np.abs(finite).max():
            continue
        scalar = STEP_SCALARS[name]
        unit, factor = SHOWN_UNITS.get(scalar.units, (scalar.units, 1.0))
        reduce = np.fmin.reduce if name in MINIMUM_SCALARS else np.fmax.reduce
        label = f"{scalar.long_name} [{unit}]" if unit else scalar.long_name
        figures.append({"name": label, "y": _packed(binned(factor * values, width, reduce))})
    return {"time": _packed(binned(1e6 * time[1:], width, np.mean)), "figures": figures, "width": width}


def damage(result: Result) -> dict | None:
    """Damage below the surfaces from RESULT.post.h5; None without this file."""
    post = damage_beside(result)
    if post is None:
        return None
    width = -(-len(post.s) // MAX_POINTS)
    decades = {side: np.log10(np.where(values > 0.0, values, np.nan)) for side, values in post.damage.items()}
    return {
        "s": _packed(binned(post.s / post.a, width, np.mean)),
        "depths": post.z.tolist(),
        "surfaces": {
            side: [_packed(binned(row, width, np.fmax.reduce)) for row in rows]
            for side, rows in decades.items()
        },
    }


def binned(values: np.ndarray, width: int, reduce: np.ufunc) -> np.ndarray:
    """Groups of `width` values reduced by `reduce(values, axis=-1)`."""
    values = np.asarray(values)
    if width == 1:
        return values
    padded = np.concatenate([values, np.repeat(values[-1:], -len(values) % width)])
    return reduce(padded.reshape(-1, width), axis=-1)


def _packed(values: np.ndarray, kind: type = np.float32) -> str:
    """Numbers as little-endian bytes in base64."""
    raw = np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<"))
    return base64.b64encode(raw).decode("ascii")
