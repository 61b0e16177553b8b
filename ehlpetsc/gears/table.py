"""Table of the points of a path of contact, and the path as a CSV file for ``[operation]``."""

from __future__ import annotations

import io
import math

import numpy as np

from ehlpetsc.gears.load_sharing import edge_contact
from ehlpetsc.gears.path import Path, describe, gear_loss_factor, hertz
from ehlpetsc.gears.standards import STANDARDS, Rating, loss_factor, values_of
from ehlpetsc.physics.hertz import hertz_line

EDGE_RADIUS = 0.05  # of the module: radius of a tip edge that is left out
EDGES = {"A": "before A, on the tip edge of the wheel", "E": "after E, on the tip edge of the pinion"}


def rows(path: Path, modulus: float, rating: Rating | None) -> list[str]:
    """Lines of text: data of the pair, a table of A to E, mean values of the standards."""
    pair = path.pair
    where = [path.index(name) for name in pair.points_on_path]
    arcs = pair.flank_arcs(path.rho)
    quantities = [
        ("time, µs", 1e6 * path.time),
        ("rho 1, mm", 1e3 * path.rho),
        ("R, mm", 1e3 * path.radius),
        ("load, kN/m", 1e-3 * path.load),
        ("u1, m/s", path.speed_1),
        ("u2, m/s", path.speed_2),
        ("u, m/s", path.entrainment),
        ("u1 - u2, m/s", path.speed_1 - path.speed_2),
        ("slide/roll", path.slide_roll_ratio),
        ("arc 1, mm", 1e3 * arcs[0]),
        ("arc 2, mm", 1e3 * arcs[1]),
    ]
    a, p0 = hertz(path, modulus)
    quantities += [("a, mm", 1e3 * a), ("p0, GPa", 1e-9 * p0)]
    lines = [*describe(path), *edges(path, modulus)]
    own, standard = gear_loss_factor(path), loss_factor(pair)
    lines.append(f"loss factor H_V {own:.4f} of this load sharing, {standard:.4f} of Niemann and Winter")
    names, values = {}, values_of(rating) if rating is not None else {}
    for name, value in values.items():
        entry = STANDARDS[name]
        if np.ndim(value):
            label = f"{name.split(' ', 1)[1]}{', ' if entry.unit else ''}{entry.unit}"
            quantities.append((label, value))
            names[label] = entry.source
        elif name != "loss factor H_V":
            lines.append(f"{name} {value:.4g} {entry.unit}{' ' if entry.unit else ''}by {entry.source}")
    width = max(len(name) for name, _ in quantities)
    lines += ["", " " * width + "".join(f"{name:>11}" for name in pair.points_on_path)]
    for name, values in quantities:
        source = f"  {names[name]}" if name in names else ""
        lines.append(f"{name:{width}}" + "".join(f"{_shown(values[i]):>11}" for i in where) + source)
    return lines


def edges(path: Path, modulus: float) -> list[str]:
    """Contact of the tip edges before A and after E, and bound of its pressure: of an elastic round edge."""
    pair, lines = path.pair, []
    edge = pair.tip_radius or EDGE_RADIUS * pair.module
    flanks = {"A": pair.points["A"], "E": pair.line_of_action - pair.points["E"]}
    for name, (way, carried) in edge_contact(pair).items():
        if way > 0.0:
            load, where = carried * pair.normal_load, EDGES[name]
            pressure = hertz_line(load, 1.0 / (1.0 / edge + 1.0 / flanks[name]), modulus)[1]
            lines += [
                f"contact {1e3 * way:.2f} mm {where}, with up to {1e-3 * load:.1f} kN/m: Hertz pressure of "
                f"an edge of radius {1e3 * edge:.3g} mm {1e-9 * pressure:.2f} GPa"
            ]
    return lines


def _shown(value: float) -> str:
    if not math.isfinite(value):
        return "-"
    digits = 3 - (math.floor(math.log10(abs(value))) if abs(value) > 1e-9 else 0)
    return f"{0.0 if abs(value) <= 1e-9 else value:.{min(max(digits, 0), 4)}f}"


def csv(path: Path) -> str:
    """Loaded part of the path as CSV text for ``[operation]``."""
    loaded = path.load > 0.0
    values = np.column_stack([path.time, path.load, path.radius, path.speed_1, path.speed_2])[loaded]
    values[:, 0] -= values[0, 0]
    text = io.StringIO()
    np.savetxt(text, values, "%.12g", ", ", header="time, load, radius, speed 1, speed 2", comments="")
    return text.getvalue()
