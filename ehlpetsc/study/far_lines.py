"""Forty lines far beyond what machine elements see: loads, speeds, oils, solids, films, sliding, meshes."""

import math

from ehlpetsc.physics.film_formulas import moes_central_film
from ehlpetsc.physics.scales import hertz_line, moes_groups, reduced_modulus
from ehlpetsc.study.lines import BARUS, FLOODED, LOAD, MODULUS, POISSON, RADIUS, SPEED, TABLE_1, Line
from ehlpetsc.study.rough_lines import ground, rough, wave

DRY = TABLE_1[: TABLE_1.index("[fluid]")] + TABLE_1[TABLE_1.index("[motion]") :]
NEWTON = TABLE_1.replace("eyring_stress = 10e6\n", "")
FURTHEST = 100.0  # half widths that an inlet may be
OPENING = 0.25  # films that the gap may open from one node to the next beside the contact
BOUNDARY = 10e-9  # m: below it no mesh is needed for the oil
COARSEST, FINEST = 100, 1600  # nodes a half width


def far_lines():
    """The lines: steady ones, then those with time steps."""
    return [*_loads(), *_speeds(), *_oils(), *_solids(), *_starved(), *_meshes(), *_rough(), *_sliding()]


def far(axis, value, *overrides, text=TABLE_1, short=False, **contact):
    """A steady line on a domain and mesh that fit its contact.

    Parameters
    ----------
    **contact
        What differs from Table 1 of `load` [N/m], `speed` [m/s], `viscosity` [Pa s], `alpha` [1/Pa],
        `radius` [m], `youngs` (both moduli) [Pa].
    """
    load, speed = contact.get("load", LOAD), contact.get("speed", SPEED)
    viscosity, alpha = contact.get("viscosity", 0.005), contact.get("alpha", 11.1e-9)
    radius, youngs = contact.get("radius", RADIUS), contact.get("youngs")
    modulus = reduced_modulus((youngs, youngs), POISSON) if youngs else MODULUS
    keys = {
        "contact.load": "load",
        "contact.radius": "radius",
        "motion.entrainment_speed": "speed",
        "fluid.viscosity": "viscosity",
        "fluid.pressure_viscosity": "alpha",
    }
    settings = [f"{key}={contact[name]!r}" for key, name in keys.items() if name in contact]
    if youngs:
        settings.append(f"contact.youngs_modulus=[{youngs!r}, {youngs!r}]")
    if "[fluid]" in text:
        m, ell = moes_groups(viscosity, speed, alpha, load, radius, modulus)
        film = math.pi / (8.0 * m) * moes_central_film(m, ell)
        inlet = min(max(2.5, math.sqrt(1.0 + 2.0 * FLOODED * film)), FURTHEST)
        a = hertz_line(load, radius, modulus)[0]
        thinnest = max(film, BOUNDARY * radius / a**2)
        points = (2.0 * math.sqrt(2.0) / 3.0 / (OPENING * thinnest)) ** (2.0 / 3.0)
        points = min(max(math.ceil(points), COARSEST if inlet < 20.0 else 40), FINEST)
        settings += [f"mesh.inlet={-inlet:.3g}", f"mesh.points_per_half_width={points}"]
    return Line(f"far {axis}", value, (*settings, *overrides), text, short)


def _loads():
    lines = [far("load", f"{load:g} N/m", load=load) for load in (0.3, 30.0, 3e3, 3e4)]
    return [*lines, far("load", "4e6 N/m (2.8 GPa)", load=4e6), far("load", "1e7 N/m (4.4 GPa)", load=1e7)]


def _speeds():
    speeds = (1e-6, 1e-4, 1e-3, 200.0, 1000.0)
    return [far("speed", f"u {u:g} m/s", speed=u, short=u == 1e-4) for u in speeds]


def _oils():
    return [
        far("oil", "eta0 1e-4 Pa s", viscosity=1e-4),
        far("oil", "eta0 30 Pa s", viscosity=30.0),
        far("oil", "eta0 1000 Pa s", viscosity=1000.0),
        far("oil", "alpha 0.1/GPa", alpha=1e-10),
        far("oil", "Barus, alpha 50/GPa", text=BARUS, alpha=50e-9),
        far("oil", "Newtonian, xi 20", "motion.slide_roll_ratio=20.0", text=NEWTON),
        far("oil", "Eyring stress 0.1 MPa", "fluid.eyring_stress=1e5"),
    ]


def _solids():
    return [
        far("solids", "E 5 MPa (rubber), 1 kN/m", youngs=5e6, load=1e3),
        far("solids", "E 1000 GPa", youngs=1e12),
        far("solids", "radius 0.1 mm, 1 kN/m", radius=1e-4, load=1e3),
        far("solids", "radius 10 m", radius=10.0),
        far("solids", "dry, smooth", text=DRY),
    ]


def _starved():
    return [
        far(
            "films", f"inlet film of {share:g} of the flooded one", f"fluid.inlet_film={share * 0.165e-6:.4g}"
        )
        for share in (0.1, 0.02)
    ]


def _meshes():
    return [
        far("mesh", "a/1600", "mesh.points_per_half_width=1600"),
        far("mesh", "a/12", "mesh.points_per_half_width=12"),
        far("mesh", "from -50 a to 20 a", "mesh.inlet=-50.0", "mesh.outlet=20.0"),
    ]


def _rough():
    both = {"one": ground(0.3e-6), "two": ground(0.3e-6, 2)}
    slow = "motion.entrainment_speed={}".format
    thin = ("contact.boundary_film=0.5e-9", 'contact.model="mixed"')
    return [
        rough("far rough", "Ra 1 um, both", one=ground(1e-6), two=ground(1e-6, 2)),
        rough("far rough", "Ra 3 um, surface 2", two=ground(3e-6)),
        rough("far rough", "Ra 0.3 um, u 0.1 m/s", slow(0.1), **both),
        rough("far rough", "Ra 0.3 um, u 0.01 m/s", slow(0.01), **both),
        rough("far rough", "mixed, boundary film 0.5 nm", *thin, **both),
        rough("far rough", "square steps of 2 um", two=wave("square", 1e-6, 100e-6)),
    ]


def _sliding():
    one, two = ground(0.15e-6), ground(0.15e-6, 2)
    return [
        *(
            rough("far sliding", f"xi {xi:g}, both rough", f"motion.slide_roll_ratio={xi}", one=one, two=two)
            for xi in (8.0, -8.0)
        ),
        *(
            rough(
                "far sliding",
                f"xi {xi:g}, 1 rough",
                f"motion.slide_roll_ratio={xi}",
                one=ground(1e-6),
            )
            for xi in (2.0, -2.0)
        ),
        far("sliding", "xi 50, smooth", "motion.slide_roll_ratio=50.0"),
        far("sliding", "xi -50, smooth", "motion.slide_roll_ratio=-50.0"),
    ]
