"""Traction curves: friction over the slide/roll ratio, with the maximum marked."""

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.pictures.labels import UNITS, conditions, legend_beside, new_figure
from ehlpetsc.pictures.operating_points import operating_point
from ehlpetsc.results.index import distinguishing_names

RATIO = "motion.slide_roll_ratio"
SIZE = (8.5, 4.6)  # inches


def draw_traction(results, _options):
    """Figure of the friction coefficient over the slide/roll ratio.

    Results that differ in other keys form separate curves; isothermal ones are dashed if others have heat.

    Raises
    ------
    OutputError
        No curve has two ratios.
    """
    curves_by_heat = {heat: _curves([r for r in results if _is_heated(r) == heat]) for heat in (False, True)}
    if not any(len(curve[0]) > 1 for curves in curves_by_heat.values() for curve in curves.values()):
        raise OutputError(f"a traction curve needs a series over {RATIO}")
    figure, axes = new_figure(1, 1, SIZE)
    names = list(dict.fromkeys([*curves_by_heat[False], *curves_by_heat[True]]))
    compared = all(curves_by_heat.values())
    for heat, curves in curves_by_heat.items():
        for name, (ratios, friction) in curves.items():
            style = "--" if compared and not heat else "-"
            colour = f"C{names.index(name)}"
            heating = ("with heat" if heat else "isothermal") if compared else ""
            label = ", ".join(filter(None, [name.replace("_", " "), heating])) or "friction"
            axes.plot(ratios, friction, style, color=colour, marker="o", ms=3, lw=1.2, label=label)
            _mark_largest(axes, ratios, friction, colour)
    axes.set_xlabel(UNITS[RATIO])
    axes.set_ylabel("friction coefficient")
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    axes.grid(lw=0.3)
    title_lines = filter(None, [results[0].attrs["title"], conditions(results)])
    axes.set_title("\n".join(title_lines), fontsize="medium")
    legend_beside(axes)
    return figure


def _is_heated(result):
    return result.case.heat is not None


def _ratio(result):
    return result.case.motion.slide_roll_ratio if result.case.motion else 0.0


def _curves(results):
    """Ratios and friction coefficients by the other conditions in which results differ."""
    ratios = sorted({_ratio(result) for result in results})
    groups = {}
    for ratio in ratios:
        same = [result for result in results if _ratio(result) == ratio]
        names = distinguishing_names(same) if len(same) > 1 else [""]
        for name, result in zip(names or [""], same, strict=False):
            groups.setdefault(name, []).append((ratio, result))
    curves = {}
    for name, members in groups.items():
        points = [(ratio, operating_point(result, ratio)) for ratio, result in members]
        rows = [(ratio, point.scalars["friction_coefficient"].mean) for ratio, point in points if point]
        curves[name] = np.array(rows).reshape(-1, 2).T
    return curves


def _mark_largest(axes, ratios, friction, colour):
    """Mark the maximum and its values unless it is at the end of a curve."""
    if friction.size < 3 or friction.argmax() in (0, friction.size - 1):
        return
    at = friction.argmax()
    axes.plot(ratios[at], friction[at], "o", ms=9, mfc="none", color=colour)
    text = f"{friction[at]:.4f} at {ratios[at]:g}"
    below = dict(xytext=(4, -7), textcoords="offset points", ha="left", va="top", fontsize="small", zorder=4)
    below["bbox"] = dict(fc="white", ec="none", alpha=0.8, pad=0.5)
    axes.annotate(text, (ratios[at], friction[at]), color=colour, **below)
