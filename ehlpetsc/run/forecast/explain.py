"""Summary of a case before its run, as text."""

from __future__ import annotations

import math
import tomllib

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.command_line import duration
from ehlpetsc.base.toml_file import combinations, keys_of
from ehlpetsc.case.assumptions import departing_keys
from ehlpetsc.case.loading import members
from ehlpetsc.case.tables import Case
from ehlpetsc.case.tables.contact import Contact
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.contact.asperities import CONTACT_PRESSURE, asperity_separation, layer_law
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.oil.oils import OILS
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast.cost import (
    expected_work,
    file_size,
    lambda_line,
    memory,
    solver_of,
    step_text,
    steps,
    surface_lines,
)
from ehlpetsc.run.forecast.mesh_error import wave_lines
from ehlpetsc.run.forecast.speed import expected_seconds
from ehlpetsc.run.forecast.validity import load_unit, warnings
from ehlpetsc.surfaces.motion.roughness import Roughness

RIDGES = (
    "Lay: in a line contact all waves are ridges across the motion; isotropic ones, as of a strip "
    "(mesh.width), carry more of the load in mixed lubrication"
)


def explain(case: Case, rough: Roughness | None = None) -> str:
    """Text summary of a case: conditions, surfaces, mesh, run time.

    `rough`: surfaces of the case; None: read here. Raises :class:`ehlpetsc.base.errors.ProfileError`.
    """
    scales = Scales.of(case)
    rough = rough or Roughness.of(case, scales)
    sections = [
        [case.title],
        _series(case) if case.series else [],
        _dry(case, scales),
        _layer(case.contact, scales),
        _default_friction(case),
        _film(case, scales, rough),
        _motion(case, scales),
        surface_lines(case, scales, rough),
        [RIDGES] * bool(rough and not KINDS[case.kind].is_areal),
        _size(case, scales, rough),
        wave_lines(case, scales, rough),
        [f"Warning: {line}" for line in warnings(case, scales, rough)],
    ]
    return "\n".join(line for section in sections for line in section)


def _dry(case: Case, s: Scales) -> list[str]:
    """Radii, load and the dry contact."""
    approach, load = case.contact.approach, f"load {s.load:g} {load_unit(case)}"
    if approach is not None:
        load = f"approach {1e6 * approach:g} um, dry {load}"
    load, pressure = f"{load}, reduced modulus {s.E / 1e9:.4f} GPa", f"p0 = {s.p0 / 1e9:.6f} GPa"
    shape, widths, more = KINDS[case.kind].part("forecast").shape(s)
    lines = [f"Contact: {shape}, {load}", f"Hertz: {widths}, maximum pressure {pressure}", *more]
    return [*lines, *_departures(case)]


def _departures(case: Case) -> list[str]:
    """Keys of which `a`, p0 and film formulas know nothing."""
    places = ", ".join(departing_keys(case))
    return [f"Hertz and film formulas are those without {places}"] if places else []


def _layer(contact: Contact, s: Scales) -> list[str]:
    """Films at which a compliant layer carries load; [] without a layer."""
    if contact.asperity_height is None:
        return []
    law = layer_law(contact, 0.5 * s.E)
    films = [1e9 * asperity_separation(pressure, *law) for pressure in (CONTACT_PRESSURE, s.p0)]
    return [
        f"Layer: rms height {1e9 * contact.asperity_height:.3g} nm; its asperities carry "
        f"{1e-6 * CONTACT_PRESSURE:g} MPa at a film of {films[0]:.3g} nm and p0 at {films[1]:.3g} nm"
    ]


def _default_friction(case: Case) -> list[str]:
    """Coefficient of friction of the solids that a case leaves out; [] if it gives one."""
    if case.default_friction is None:
        return []
    default = f"{case.default_friction:g}, the default of contact.boundary_friction"
    return [f"Solids: coefficient of friction {default}, where they touch"]


def _film(case: Case, s: Scales, rough: Roughness | None) -> list[str]:
    if case.fluid is None:
        return ["Film: none, dry contact"]
    central, minimum = smooth_films(s, case.fluid, s.conditions)
    formulas = KINDS[case.kind].part("forecast").formulas
    oil = [f"Oil {case.fluid.oil}: {OILS[case.fluid.oil].source}"] if case.fluid.oil else []
    return [
        *oil,
        f"Film: {case.fluid.law} viscosity, {s.eta0:g} Pa s at ambient pressure, pressure-viscosity "
        f"coefficient {1e9 * case.fluid.pressure_viscosity:.3g} 1/GPa; Moes M = {s.moes_m:.2f}, "
        f"L = {s.moes_l:.2f}",
        f"Expected smooth film ({formulas}, and the density under p0): central {central * 1e6:.3g} um, "
        f"minimum {minimum * 1e6:.3g} um",
        *lambda_line(case, s, rough),
    ]


def _motion(case: Case, s: Scales) -> list[str]:
    if case.motion is None:
        return ["Motion: none"]
    if case.conditions is not None:
        return _variable(case, s)
    line = f"Motion: mean {s.u:g} m/s, slide/roll ratio {s.xi:g}; surfaces 1, 2 at {s.u1:g}, {s.u2:g} m/s"
    lines = [line, *_across(s)]
    if case.time is None:
        return [*lines, "Time: steady"]
    return [
        *lines,
        f"Time: the faster surface moves {case.time.travel:g} a = {s.u_max * s.duration * 1e3:.3f} mm in "
        f"{s.duration * 1e3:.4f} ms, {steps(case, s)} steps of {s.dt * 1e9:.2f} ns",
        *["Start: rough, after a ramp before time 0"] * (case.time.start == "rough"),
        *_post(case, s),
    ]


def _across(s: Scales) -> list[str]:
    """Line on speeds that vary over the rows of the dry contact; [] of one speed."""
    if not s.across.varies:
        return []
    y, sliding = s.across.y, s.across.sliding(s.conditions)
    inside = abs(y) <= s.b
    low, high = sliding[inside].min(), sliding[inside].max()
    bands = " and ".join(f"{1e3 * row:.3g}" for row in s.across.rolling_rows(s.conditions) if abs(row) <= s.b)
    spin = f"; spin {s.across.spin:g} rad/s" if s.across.spin else ""
    rolling = f"; pure rolling at y = {bands} mm" if bands else ""
    return [f"Across: sliding along x {low:.3g} to {high:.3g} m/s within b{rolling}{spin}"]


def _post(case: Case, s: Scales) -> list[str]:
    """Line on body points none of which passes the whole mesh, as post-processing needs; [] if some do."""
    width = (s.x[-1] - s.x[0]) * s.a
    short = {side: speed for side, speed in (("1", s.u1), ("2", s.u2)) if abs(speed) * s.duration < width}
    slowest = min(map(abs, short.values()), default=0.0)
    if not short:
        return []
    needed = "which rests"
    if slowest:
        needed = f"as post needs for it; time.travel = {math.ceil(width / s.a * s.u_max / slowest)} is enough"
    of = "either surface" if len(short) == 2 else f"surface {next(iter(short))}"
    return [f"Post-processing: no point of {of} passes the whole mesh, {width / s.a:g} a, {needed}"]


def _variable(case: Case, s: Scales) -> list[str]:
    """Ranges of conditions that change with time."""
    table, operation = case.conditions, operation_of(case, s)
    origin = "gear pair" if case.gears else "table"

    def range_of(values: np.ndarray, unit: str) -> str:
        low, high = values.min(), values.max()
        return f"{low:.4g} {unit}" if low == high else f"{low:.4g} to {high:.4g} {unit}"

    repeats = f", {table.repeat} times" if table.repeat > 1 else ""
    moved = 1e3 * s.a * case.time.travel
    factor, unit = (1.0, "N") if KINDS[case.kind].is_whole else (1e-3, "kN/m")
    return [
        f"Conditions of a {origin}{repeats}: load {range_of(factor * table.load, unit)}, "
        f"radius {range_of(1e3 * table.radius, 'mm')}; above, those of the widest contact",
        f"Motion: mean {range_of(table.entrainment, 'm/s')}; surface 1 {range_of(table.u1, 'm/s')}, "
        f"surface 2 {range_of(table.u2, 'm/s')}",
        f"Time: {1e3 * operation.duration:.4f} ms, the faster surface moves {moved:.3f} mm; "
        + step_text(case, s),
    ]


def _size(case: Case, s: Scales, rough: Roughness | None) -> list[str]:
    passes = case.time.passes if case.time else 1
    each = f" for each of {passes} passes" if passes > 1 else ""
    nodes = " x ".join(map(str, s.grid.shape[::-1]))
    spacing = " x ".join(f"{1e6 * length:.3f}" for length in s.grid.spacings[::-1])
    extent = f"from {s.x[0]:g} to {s.x[-1]:g} a"
    about = "at most" if case.time and case.time.tolerance else "about"
    if KINDS[case.kind].is_areal:
        strip, y = 0.5 * s.grid.breadth, s.grid.axes[0] * s.a / s.b
        low, high, unit = (-strip, strip, "a") if s.grid.periodic else (y[0], y[-1], "b")
        extent += f" along, {low:g} to {high:g} {unit} across"
    return [
        f"Mesh: {nodes} nodes {extent}, spacing {spacing} um; {2 * s.grid.n + 1} unknowns",
        f"Run time on one rank: {_time(case.kind, expected_work(case, s, rough), about)}; "
        f"result file: {about} {_file_size(file_size(case, s))}{each}; "
        f"memory: about {1e-6 * memory(s, rough, case.heat is not None):.0f} MB",
    ]


def _file_size(count: float) -> str:
    """Size of a file of so many bytes."""
    return f"{1e-6 * count:.1f} MB" if count < 1e9 else f"{1e-9 * count:.3g} GB"


def _time(kind: str, amount: float, about: str = "about") -> str:
    """Expected time of an amount of work."""
    seconds = expected_seconds(solver_of(kind), amount)
    if seconds is None:
        return f"no estimate yet, the first run of a {solver_of(kind)} measures this machine"
    return f"{about} {duration(seconds)}, as fast as the last runs here"


def _series(case: Case) -> list[str]:
    """Members of a series and their total cost."""
    series = tomllib.loads(case.text)["series"]
    values = "; ".join(
        f"{key} = {', '.join(map(str, values))}"
        for key, values in zip(keys_of(series), zip(*combinations(series), strict=True), strict=True)
    )
    amount, size = 0.0, 0.0
    for _, member in members(case):
        scales = Scales.of(member)
        amount += expected_work(member, scales, Roughness.of(member, scales))
        size += file_size(member, scales)
    return [
        f"A series: {values}; below, the base case.",
        f"All members on one rank: {_time(case.kind, amount)}; result files: about {_file_size(size)}",
    ]
