"""The lines of the table of extremes that take time steps: roughness, mesh, domain, starts."""

from dataclasses import replace

from ehlpetsc.physics.scales import hertz_line
from ehlpetsc.study.lines import LOAD, MODULUS, PROFILES, RADIUS, TABLE_1, Line

CORRELATION = 25e-6  # m
SHORT_DOMAIN = ("mesh.inlet=-1.5", "mesh.outlet=1.3", "output.every=1000000", 'output.fields=["pressure"]')
A = hertz_line(LOAD, RADIUS, MODULUS)[0]  # half width of TABLE_1 [m]


def ground(ra, seed=1, correlation=CORRELATION):
    """Setting of a random ground profile."""
    shape = f"correlation = {correlation:g}, skewness = -1.0"
    return f'{{ kind = "ground", ra = {ra:g}, {shape}, seed = {seed} }}'


def wave(kind, amplitude, wavelength):
    """Setting of a sine, square, ridge or dent."""
    return f'{{ kind = "{kind}", amplitude = {amplitude:g}, wavelength = {wavelength:g} }}'


def rough(axis, value, *overrides, one=None, two=None, travel=2.5, short=False):
    """A line of time steps from the smooth start, the inlet near so that few steps fill the contact."""
    settings = [*SHORT_DOMAIN, f"time.travel={travel}"]
    for side, spec in (("1", one), ("2", two)):
        settings += [f"surface.{side}.synthetic={spec}"] if spec else []
    return Line(axis, value, (*settings, *overrides), TABLE_1, short)


def time_lines():
    """Roughness, domain and mesh, sliding of rough surfaces, start."""
    return [*_roughness(), *_features(), *_measured(), *_rough_sliding(), *_domain(), *_starts()]


def _roughness():
    lines = [
        rough(
            "roughness",
            f"Ra {ra * 1e6:g} um, both surfaces",
            one=ground(ra),
            two=ground(ra, 2),
            short=ra in (0.01e-6, 0.3e-6),
        )
        for ra in (0.01e-6, 0.1e-6, 0.3e-6, 1.0e-6)
    ]
    lines += [
        rough("roughness", f"Ra {ra * 1e6:g} um, {side} surface only", **{side: ground(ra)})
        for ra, side in ((0.3e-6, "1"), (0.3e-6, "2"), (1.0e-6, "2"))
    ]
    return lines


def _features():
    lines = [
        rough("roughness", f"sine 0.1 um, wavelength {name}", two=wave("sine", 0.1e-6, length))
        for name, length in (
            ("6 nodes", 0.06 * A),
            ("12 nodes", 0.12 * A),
            ("0.5 a", 0.5 * A),
            ("2 a", 2 * A),
        )
    ]
    lines += [
        rough(
            "roughness",
            f"square steps {height:g} um, wavelength {name}",
            two=wave("square", height * 0.5e-6, length),
            short=height == 0.5,
        )
        for height, name, length in ((0.2, "0.5 a", 0.5 * A), (0.5, "0.5 a", 0.5 * A), (1.0, "2 a", 2 * A))
    ]
    lines += [
        rough(
            "roughness",
            f"single spike of 1 um, {width} um wide, {side}",
            **{side: wave("ridge", 1e-6, width * 1e-6)},
            short=width == 20,
        )
        for width, side in ((10, "2"), (20, "2"), (20, "1"), (60, "2"))
    ]
    return [*lines, rough("roughness", "single dent of 1 um, 60 um wide", two=wave("dent", 1e-6, 60e-6))]


def _measured():
    dusty = f'surface.2.file="{PROFILES / "hommel_stylus_profile.csv"}"'
    meander = PROFILES / "alicona_meander_profile.csv"
    lines = [
        rough("roughness", "dusty stylus profile", dusty, short=True),
        rough("roughness", "dusty stylus profile, eta0 0.002", dusty, "fluid.viscosity=0.002"),
    ]
    lines += [
        rough(
            "roughness",
            f"measured profile x {scale:g}, both, eta0 {eta:g}",
            f"fluid.viscosity={eta}",
            *(
                f"surface.{side}.{key}"
                for side in ("1", "2")
                for key in (f'file="{meander}"', f"scale={scale}")
            ),
        )
        for scale, eta in ((0.2, 0.01), (0.5, 0.002), (1.0, 0.003), (0.5, 0.0005))
    ]
    return lines


def _rough_sliding():
    return [
        rough(
            "rough sliding",
            f"xi {xi:g}, Ra 0.15 um, both",
            f"motion.slide_roll_ratio={xi}",
            one=ground(0.15e-6),
            two=ground(0.15e-6, 2),
            short=xi in (2.0, -4.0),
        )
        for xi in (0.0, 1.0, -1.0, 1.9, 2.0, -2.0, 4.0, -4.0)
    ]


def _domain():
    both = {"one": ground(0.15e-6), "two": ground(0.15e-6, 2)}
    lines = [
        rough("domain", f"inlet {inlet:g} a", f"mesh.inlet={inlet}", travel=1.5 - inlet, **both)
        for inlet in (-1.5, -2.5, -6.0)
    ]
    lines += [
        rough(
            "mesh",
            f"a/{points}",
            f"mesh.points_per_half_width={points}",
            travel=travel,
            short=points == 25,
            **both,
        )
        for points, travel in ((25, 2.5), (50, 2.5), (200, 1.5), (400, 1.0), (800, 0.7))
    ]
    lines += [
        rough("mesh", f"near field {nodes}", f"mesh.near_field={nodes}", short=nodes == 5, travel=1.5, **both)
        for nodes in (5, 50, 100)
    ]
    lines += [
        rough(
            "time step",
            f"courant {courant:g}",
            f"time.courant={courant}",
            travel=0.8 if courant < 0.1 else 2.5,
            short=courant == 4,
            **both,
        )
        for courant in (0.05, 0.2, 1.0, 2.0, 4.0)
    ]
    return lines


def _starts():
    both = {"one": ground(0.15e-6), "two": ground(0.15e-6, 2)}

    def before(line, *changed):  # shorter, and with a restart file after every step
        return (*line.overrides, "time.travel=0.5", "output.checkpoint=1e-6", *changed)

    plain = rough("start", "", **both)
    thin = rough("start", "restart of eta0 0.01 at 0.002", "fluid.viscosity=0.002", **both)
    thick = rough("start", "restart of eta0 0.002 at 0.01", "fluid.viscosity=0.01", **both)
    # the mesh stays as it is in half widths, as a restart asks for
    heavier = (f"contact.load={LOAD * 1.5625}", "time.travel=2.0")
    lighter = (f"contact.load={LOAD / 1.5625}", "time.travel=3.0")
    return [
        rough("start", "from smooth", **both),
        _restarted(thin, before(thin, "fluid.viscosity=0.01"), short=True),
        _restarted(thick, before(thick, "fluid.viscosity=0.002")),
        _restarted(rough("start", "load suddenly 1.56 times", *heavier, **both), before(plain), short=True),
        _restarted(rough("start", "load suddenly 0.64 times", *lighter, **both), before(plain)),
    ]


def _restarted(line, before, short=False):
    return replace(line, before=before, short=short)
