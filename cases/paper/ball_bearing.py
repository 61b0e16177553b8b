r"""Torque of a deep groove ball bearing 6206 under axial load beside the model of a catalogue.

``./run_mpi.sh python cases/paper/ball_bearing.py [-o PICTURE]`` computes the contacts of a ball with both
rings, with heat: as a ball that only rolls, in its groove (Heathcote slip), and with spin. It prints the
torque of the bearing from rolling and from sliding beside both terms of the catalogue, and draws the inner
contact and the torque over the speed. Nothing is fitted.

The inner ring turns. All spin is at its contact (control by the outer race); its speed about the normal is
that of the ring times :math:`\sin\alpha`. The mean sliding of each contact is such that it has no force of
sliding. Assumed: grooves of 0.52 of the ball's diameter. Not in it: cage, churned oil, starvation.

The catalogue's model (SKF, general catalogue: friction), its equations and constants as in a public program:
rolling :math:`\phi_{ish}G_{rr}(\nu n)^{0.6}`, sliding :math:`\mu G_{sl}`. Loads in N, torque in N mm and
:math:`\mu` = 0.05 of mineral oils in full film are from memory. The starvation of its rolling term is left
out here too.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import measured_data
import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.oil.viscosity_laws import KELVIN, walther, walther_constants
from ehlpetsc.pictures import style
from ehlpetsc.run.simulation import AcceptedState, Simulation

BALLS, BALL, PITCH, STATIC_LOAD = 9, 9.525e-3, 46e-3, 11.3e3  # number, diameter, pitch diameter [m]; C0 [N]
OSCULATION = 0.52  # radius of the grooves over the diameter of the ball, assumed
OIL, V40, V100, CELSIUS = "fva3", 90.02e-6, 10.41e-6, 70.0  # m^2/s
MESH = {"inlet": -4.0, "outlet": 1.8, "width": 3.2, "points_per_half_width": [20, 40]}
SPEEDS = 1000.0, 2000.0, 4000.0, 8000.0  # 1/min
LOADS = 500.0, 1000.0, 2000.0  # N along the axis
LOAD, SPEED = 1000.0, 2000.0  # of the picture
R1, R2, S1, S2 = 3.9e-7, 1.7, 3.23e-3, 36.5  # of series 62, for mm, N, N mm
FULL_FILM_FRICTION, BOUNDARY_FRICTION = 0.05, 0.12  # of the catalogue's sliding term
BAND = 0.35  # of b: rolling without a force, for a first guess
SCENES: dict[str, dict[str, Any]] = {
    "rolling": {"contact.groove_radius": None, "motion.spin": None, "motion.slide_roll_ratio": 0.0},
    "Heathcote": {"motion.spin": None},
    "Heathcote and spin": {},
}


class Torque(NamedTuple):
    """Torque of a bearing from rolling and from sliding [N m]."""

    rolling: float
    sliding: float

    @property
    def total(self) -> float:
        """Sum of both."""
        return self.rolling + self.sliding


def contact_angle(load: float) -> float:
    """Contact angle under an axial load [N], as of the catalogue."""
    return float(np.radians(24.6 * (load / STATIC_LOAD) ** 0.24))


def viscosity() -> float:
    """Kinematic viscosity of the oil [mm^2/s]."""
    return float(walther(CELSIUS + KELVIN, *walther_constants(V40, V100))[0])


def catalogue(load: float, rotation: float) -> Torque:
    """Torque by the catalogue: `load` [N] along the axis, `rotation` [1/min]."""
    pitch, sine, nu = 1e3 * PITCH, np.sin(contact_angle(load)), viscosity()
    g_rr = R1 * pitch**1.96 * (R2 / sine * load) ** 0.54
    g_sl = S1 * pitch**-0.145 * (S2 * pitch**1.5 / sine * load**4) ** (1.0 / 3.0)
    heating = 1.0 / (1.0 + 1.84e-9 * (rotation * pitch) ** 1.28 * nu**0.64)
    boundary = np.exp(-2.6e-8 * (rotation * nu) ** 1.4 * pitch)
    friction = boundary * BOUNDARY_FRICTION + (1.0 - boundary) * FULL_FILM_FRICTION
    return Torque(1e-3 * heating * g_rr * (nu * rotation) ** 0.6, 1e-3 * g_sl * friction)


def case_of(ring: str, load_along: float, rotation: float, changes: dict[str, Any]) -> Case:
    """Contact of a ball with a ring, "inner" or "outer"; `changes`: keys of the case."""
    angle, ball, groove = contact_angle(load_along), 0.5 * BALL, OSCULATION * BALL
    gamma, turning = BALL * np.cos(angle) / PITCH, np.pi / 30.0 * rotation
    turned = -1.0 if ring == "inner" else 1.0
    case = {
        "title": f"Ball of a bearing 6206, {ring} ring",
        "contact": {
            "radius": [ball * (1.0 + turned * gamma), 1.0 / (1.0 / ball - 1.0 / groove)],
            "groove_radius": groove,
            "load": load_along / (BALLS * np.sin(angle)),
            "material": "100Cr6",
        },
        "fluid": {"oil": OIL, "temperature": CELSIUS + KELVIN},
        "heat": {"bulk_temperature": CELSIUS + KELVIN, "conductivity": 21.0},
        "motion": {
            "entrainment_speed": 0.25 * turning * PITCH * (1.0 - gamma**2),
            "slide_roll_ratio": 0.0,
            "spin": turning * np.sin(angle) if ring == "inner" else 0.0,
        },
        "mesh": MESH,
    }
    return load(case, changes)


def solved(ring: str, load_along: float, rotation: float, scene: str) -> tuple[Case, AcceptedState]:
    """Contact of a scene without a force of sliding: a secant from that of even friction."""
    given = ring, load_along, rotation

    def at(ratio: float) -> tuple[Case, AcceptedState, float]:
        case = case_of(*given, {"motion.slide_roll_ratio": ratio} | SCENES[scene])
        (state,) = Simulation(case)
        return case, state, 0.5 * (state.friction - state.friction_1)

    scales = Simulation(case_of(*given, {})).scales
    if scene == "rolling":
        return at(0.0)[:2]
    slip = scales.across.curvatures[1] - scales.across.curvatures[0]
    first, second = (slip * (band * scales.b) ** 2 for band in (BAND, 0.8 * BAND))
    forces = [at(ratio)[2] for ratio in (first, second)]
    return at(first - forces[0] * (second - first) / (forces[1] - forces[0]))[:2]


def power(case: Case, state: AcceptedState) -> tuple[float, float]:
    """Power of a contact from rolling and from sliding [W]."""
    if case.contact.groove_radius is None:
        speed = case.motion.entrainment_speed
        return -speed * (state.friction + state.friction_1), 0.0
    return state.friction_power - state.sliding_power, state.sliding_power


def torque(load_along: float, rotation: float, scene: str = "Heathcote and spin") -> Torque:
    """Computed torque of the bearing."""
    powers = [power(*solved(ring, load_along, rotation, scene)) for ring in ("inner", "outer")]
    return Torque(*(BALLS / (np.pi / 30.0 * rotation) * sum(both) for both in zip(*powers, strict=True)))


def draw(found: dict[str, list[Torque]], shown: tuple[Case, AcceptedState], plain: AcceptedState) -> Figure:
    """Sliding speed over the inner contact, film and sliding across, torque over the speed."""
    case, state = shown
    scales = Simulation(case).scales
    figure, (over, across, panel) = style.new_figure(1, 3, (11.0, 3.8))
    y, x, inside = 1e3 * scales.across.y, scales.grid.x, scales.grid.distance.reshape(scales.grid.shape)
    most = state.sliding_speed[inside <= 1.0].max()
    colours = dict(shading="gouraud", cmap="viridis", rasterized=True, vmin=0.0, vmax=most)
    drawn = over.pcolormesh(x, y, state.sliding_speed, **colours)
    over.contour(x, y, inside, [1.0], colors="w", linewidths=1.0)
    over.set(xlabel=style.ACROSS, ylabel="y [mm]", xlim=(-1.3, 1.3), title="sliding speed [m/s]")
    over.set_ylim(-1.15e3 * scales.b, 1.15e3 * scales.b)
    figure.colorbar(drawn, ax=over)
    row = np.argmin(abs(x))
    across.plot(y, 1e6 * plain.film_thickness[:, row], color=style.FILM, label="rolling")
    across.plot(y, 1e6 * state.film_thickness[:, row], "k:", label="Heathcote and spin")
    across.set(xlabel="y [mm]", ylabel="film at x = 0 [um]", ylim=(0.0, 1.6e6 * state.film_central))
    slides = across.twinx()
    slides.plot(y, scales.across.sliding(scales.conditions), color=style.SECOND, lw=1.0)
    slides.axhline(0.0, color=style.SECOND, lw=0.4)
    slides.set_ylabel("sliding speed along x [m/s]", color=style.SECOND)
    slides.set_ylim(-1.1 * most, 0.3 * most)
    across.set_xlim(-1.15e3 * scales.b, 1.15e3 * scales.b)
    across.legend(loc="lower center", **style.SMALL)
    for (name, values), colour in zip(found.items(), style.shades(len(found)), strict=True):
        panel.plot(SPEEDS, [1e3 * one.total for one in values], color=colour, label=name)
    for name, part, line in (("total", "total", "-"), ("rolling", "rolling", "--")):
        given = [1e3 * getattr(catalogue(LOAD, speed), part) for speed in SPEEDS]
        panel.plot(SPEEDS, given, "k", ls=line, lw=0.8, marker="o", ms=3, label=f"catalogue, {name}")
    panel.set(xlabel="speed of the inner ring [1/min]", ylabel="torque [N mm]", ylim=(0.0, None))
    panel.legend(loc="lower right", **style.SMALL)
    style.set_title(figure, f"Bearing 6206, {1e-3 * LOAD:g} kN along its axis, oil of {CELSIUS:g} °C")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the tables and write the picture."""
    chosen = measured_data.parser(__doc__, "ball_bearing.png").parse_args(words)
    print(
        "load [N], speed [1/min], scene: torque [N mm] of rolling; of sliding; catalogue's rolling; sliding"
    )
    found: dict[str, list[Torque]] = {scene: [] for scene in SCENES}
    for along in LOADS:
        for rotation in SPEEDS if along == LOAD else (SPEED,):
            given = catalogue(along, rotation)
            for scene in SCENES if along == LOAD else list(SCENES)[-1:]:
                one = torque(along, rotation, scene)
                found[scene] += [one] if along == LOAD else []
                values = *(1e3 * value for value in one), *(1e3 * value for value in given)
                print(
                    f"{along:g}, {rotation:g}, {scene}: " + "; ".join(f"{v:.2f}" for v in values), flush=True
                )
    shown = solved("inner", LOAD, SPEED, "Heathcote and spin")
    plain = solved("inner", LOAD, SPEED, "rolling")[1]
    style.save(draw(found, shown, plain), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
