"""Data of the page of one result, thinned to the resolution of a screen."""

import base64

import numpy as np

from ehlpetsc.pictures.frames import default_window, frame_to_show, travel_of
from ehlpetsc.quantities import STEP_SCALARS
from ehlpetsc.results.contacts import in_contact
from ehlpetsc.results.means import means
from ehlpetsc.results.post_result import damage_beside

MAX_FRAMES, MAX_NODES, MAX_ROWS, MAX_POINTS = 200, 1200, 2000, 2000  # on a page
MIN_CHANGE = 1e-9  # relative change over a run below which a scalar counts as constant
ERROR_SCALARS = {"load_error", "mass_error"}  # relative errors: changes by rounding do not count
MINIMUM_SCALARS = {
    "h_min",
    "film_central",
    "mean_gap_ratio",
}  # of several steps the minimum is shown, else the maximum
SHOWN_UNITS = {
    "m": ("µm", 1e6),
    "Pa": ("GPa", 1e-9),
    "s": ("µs", 1e6),
    "N/m": ("N/mm", 1e-3),
    "1": ("", 1.0),
}
HIDDEN_SCALARS = {"step", "time", "load", "wall"}
MEAN_LABELS = {
    "friction_coefficient": "mean friction coefficient",
    "film_central": "mean central film",
    "lambda_ratio": "lambda ratio",
    "mean_gap_ratio": "mean gap ratio",
    "contact_share": "mean share of the load on the solids",
}  # over the time in which both surfaces fill the contact
MEAN_FORMATS = {name: "{:.4g}".format for name in MEAN_LABELS} | {
    "film_central": lambda film: f"{1e6 * film:.4g} µm",
    "contact_share": lambda share: f"{100.0 * share:.3g} %",
}
LEADING_SCALARS = (
    "friction_coefficient",
    "contact_share",
    "h_min",
    "film_central",
    "p_max",
    "mean_gap_ratio",
    "contacts",
)


def report_data(result):
    """Data of the page, for JSON.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result

    Returns
    -------
    dict
    """
    attrs = result.attrs
    return {
        "title": str(attrs["title"]),
        "facts": facts(result),
        "case": str(attrs["case"]),
        "frames": frames(result),
        "steps": scalars_over_time(result),
        "damage": damage(result),
    }


def _oil(fluid):
    grade = fluid.grade
    words = [
        f"{1e3 * fluid.viscosity:.4g} mPa s",
        f"{1e6 * grade.v40:g} and {1e6 * grade.v100:g} mm²/s at 40 and 100 °C" if grade else None,
        fluid.law,
    ]
    return "oil", ", ".join(filter(None, words))


def _temperatures(result):
    """Highest temperatures of film and surfaces; None for an isothermal run."""
    names = ("film_temperature_max", "temperature_1_max", "temperature_2_max")
    if names[0] not in result.scalars:
        return None
    values = ", ".join(f"{np.nanmax(result.steps(name)) - 273.15:.1f}" for name in names)
    return "highest temperature of film, surface 1, surface 2", f"{values} °C"


def facts(result):
    """Names and values of the table at the top."""
    attrs = result.attrs
    case = result.case
    contact_details = [f"{case.contact.model} contact"]
    if case.conditions is None:
        sizes = f"radius {1e3 * case.contact.radius:g} mm", f"load {1e-3 * case.contact.load:g} N/mm"
        contact_details = [*sizes, *contact_details]
    rows = [
        ("ended as", str(attrs.get("status", "unknown"))),
        ("contact", ", ".join(contact_details)),
        _oil(case.fluid) if case.fluid else None,
        ("half width a, pressure p0", f"{1e3 * attrs['a']:.4g} mm, {1e-9 * attrs['p0']:.4g} GPa"),
        case.motion and ("speeds of surface 1 and 2", f"{attrs['u1']:.4g} and {attrs['u2']:.4g} m/s"),
        ("nodes, steps", f"{len(result.x)}, {len(result.steps('time')) - 1}"),
        ("minimum film", f"{1e6 * np.nanmin(result.steps('h_min')):.4g} µm"),
        ("maximum pressure", f"{1e-9 * np.nanmax(result.steps('p_max')):.4g} GPa"),
        *((MEAN_LABELS[name], MEAN_FORMATS[name](value)) for name, value in means(result).items()),
        _temperatures(result),
    ]
    for name, words in (
        ("load_error", "largest error of the load"),
        ("mass_error", "largest error of the oil balance"),
    ):
        values = result.steps(name)
        if np.isfinite(values).any():
            rows.append((words, f"{np.nanmax(values):.2g}"))
    limits = str(attrs.get("limits", "")).strip().splitlines()
    return [row for row in rows if row] + [("limit", line) for line in limits]


def frames(result):
    """Pressure, film and contacts of stored frames in view."""
    low, high = default_window([result])
    x = result.x / result.attrs["a"]
    in_view = np.flatnonzero((x >= low) & (x <= high))
    columns, width = slice(in_view[0], in_view[-1] + 1), -(-len(in_view) // MAX_NODES)
    last = len(result.time) - 1
    fullest = frame_to_show(result)
    chosen = np.unique(
        np.append(np.linspace(0, last, min(last + 1, MAX_FRAMES)).round().astype(int), fullest)
    )
    names = {"pressure": (1e-9, np.max), "film_thickness": (1e6, np.min), "contact_pressure": (1e-9, np.max)}
    stored = {name: scaling for name, scaling in names.items() if name in result}
    fields = {
        name: _packed([binned(factor * result.frame(name, k)[columns], width, reduce) for k in chosen])
        for name, (factor, reduce) in stored.items()
    }
    touching = [binned(in_contact(result, k, columns), width, np.max) for k in chosen]
    return {
        "x": _packed(binned(x[columns], width, np.mean)),
        "time": _packed(1e6 * result.time[chosen]),
        "step": [int(step) for step in result.step[chosen]],
        "travel": travel_of(result)[chosen].tolist(),
        "first": int(np.searchsorted(chosen, fullest)),
        "p0": 1e-9 * float(result.attrs["p0"]),
        "width": width,
        "contact": _packed(touching, np.uint8),
        **fields,
    }


def scalars_over_time(result):
    """Varying scalars of the steps over time; empty for a steady result."""
    time = result.steps("time")
    if len(time) < 2:
        return {"time": _packed([]), "figures": []}
    width, figures = -(-len(time) // MAX_ROWS), []
    for name in sorted(set(result.scalars) - HIDDEN_SCALARS, key=_sort_key):
        values = result.steps(name).astype(float)[1:]
        finite = values[np.isfinite(values)]
        if not finite.size or np.ptp(finite) <= MIN_CHANGE * max(np.abs(finite).max(), name in ERROR_SCALARS):
            continue
        attributes = result[f"steps/{name}"].attrs
        units = attributes.get("units", "1")
        unit, factor = SHOWN_UNITS.get(units, (units, 1.0))
        words = attributes.get("long_name", name.replace("_", " "))
        reduce = np.fmin.reduce if name in MINIMUM_SCALARS else np.fmax.reduce
        label = f"{words} [{unit}]" if unit else words
        figures.append({"name": label, "y": _packed(binned(factor * values, width, reduce))})
    return {"time": _packed(binned(1e6 * time[1:], width, np.mean)), "figures": figures, "width": width}


def _sort_key(name):
    """Sort key of the charts: `LEADING_SCALARS` first, then in the order of the table of quantities."""
    order = list(STEP_SCALARS)
    return (
        LEADING_SCALARS.index(name) if name in LEADING_SCALARS else len(LEADING_SCALARS),
        order.index(name) if name in order else len(order),
        name,
    )


def damage(result):
    """Damage below the surfaces from RESULT.post.h5; None without this file."""
    post = damage_beside(result)
    if post is None:
        return None
    width = -(-len(post.s) // MAX_POINTS)
    with np.errstate(divide="ignore", invalid="ignore"):
        decades = {side: np.log10(values) for side, values in post.damage.items()}
    for values in decades.values():
        values[~np.isfinite(values)] = np.nan
    return {
        "s": _packed(binned(post.s / post.a, width, np.mean)),
        "depths": post.z.tolist(),
        "surfaces": {
            side: [_packed(binned(row, width, np.fmax.reduce)) for row in rows]
            for side, rows in decades.items()
        },
    }


def binned(values, width, reduce):
    """Groups of `width` values reduced by `reduce(values, axis=-1)`."""
    values = np.asarray(values)
    if width == 1:
        return values
    short = -len(values) % width
    padded = np.concatenate([values, np.repeat(values[-1:], short)])
    return reduce(padded.reshape(-1, width), axis=-1)


def _packed(values, kind=np.float32):
    """Numbers as little-endian bytes in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<"))).decode(
        "ascii"
    )
