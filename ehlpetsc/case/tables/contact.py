"""Keys of `[contact]`: solids, load, contact model."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ehlpetsc.base.case import Contact, Fluid
from ehlpetsc.base.declarations import Key, KeyTable, Refused, Required
from ehlpetsc.base.materials import GRADES, STEELS
from ehlpetsc.physics.contact.profiles import ALONG, PROFILES
from ehlpetsc.physics.oil.laws import DENSITY_LAWS, LAW_TABLES, LAWS, completed
from ehlpetsc.physics.oil.oils import OILS

BOUNDARY_FILM = 10e-9  # m: an adsorbed or reacted layer has 2 to 50 nm
ASPERITY_SLOPE = 0.1  # ground and superfinished steel
LAYER_NODES = 8  # longest wave of a layer whose surfaces have no short_cutoff, in nodes
MIXED = 'contact.model = "mixed"'
VARYING = ("[gears]", "[operation]")
LAYER = "contact.asperity_height"
ROLLERS = ("roller", "window")


PROFILE = {
    name: KeyTable(
        "contact.profile",
        "profile of a roller along its length",
        {"kind": Required("of profile", choices=(name,), equation=law.equation)} | law.keys,
        needs=("contact.length",),
        complete=law.check,
    )
    for name, law in PROFILES.items()
}
"""Keys of the profile of a roller by its kind."""

ALONG_TABLES = {
    name: KeyTable(
        "contact.profile_along",
        "profile along the direction of motion",
        {"kind": Required("of profile", choices=(name,), equation=law.equation)} | law.keys,
        complete=law.check,
    )
    for name, law in ALONG.items()
}
"""Keys of the profile along the motion by its kind."""


def _complete(contact: Contact) -> dict[str, Any]:
    _check_profile(contact)
    radii = contact.radius if isinstance(contact.radius, tuple) else (contact.radius, None)
    values = dict(zip(("radius", "radius_across"), radii, strict=True))
    if contact.law == "mixed":
        values["boundary_film"] = contact.boundary_film or BOUNDARY_FILM
    if contact.law == "compliant":
        values["asperity_slope"] = contact.asperity_slope or ASPERITY_SLOPE
    return values


def _check_profile(contact: Contact) -> None:
    """Refuse a profile that does not fit the length of its roller."""
    if contact.profile is None or contact.length is None:
        return
    values = vars(contact.profile)
    for key in ("straight", "middle"):
        if values.get(key) is not None and values[key] >= contact.length:
            raise Refused(f"{key} = {values[key]:g} m; allowed: less than contact.length", "profile")
    ends = values.get("y")
    if ends and (ends[-1] < 0.5 * contact.length or -0.5 * contact.length < ends[0] != 0.0):
        reach = f"y from {ends[0]:g} to {ends[-1]:g} m"
        allowed = "to half of contact.length, from 0 or from minus that"
        raise Refused(f"{reach}; allowed: {allowed}", "profile")


COATING = KeyTable(
    "contact.coating",
    "layer bonded to body 1, or a list of two, of bodies 1 and 2, {} for none; `a`, `p0` and film formulas "
    "are those of the bodies without it",
    {
        "thickness": Required("of the layer", "m", 1e-9, 1e-2),
        "youngs_modulus": Required("of the layer", "Pa", 1e6, 1e14),
        "poisson_ratio": Required("of the layer", "", 0, 0.5),
    },
)

KEYS = {
    "radius": Required(
        "reduced radius, `1/R = 1/R1 + 1/R2`; two, along and across the motion: a point contact",
        *("m", 1e-9, 100),
        many="axes",
        replaced_by=VARYING,
    ),
    "load": Required(
        "load per length of contact, `w`, the integral of `p`; `a = sqrt(8 w R/(pi E'))`, `p0 = 2 w/(pi a)`; "
        "of a point contact and a roller its load [N]",
        *("N/m", 1e-3, 1e10),
        point_unit="N",
        replaced_by=(*VARYING, "approach"),
    ),
    "approach": Key(
        "of a point contact in place of its load: rigid-body approach `delta` from the first touch of the "
        "smooth bodies; `a` and `p0` are those of the dry contact with this approach",
        *("m", 1e-9, 1e-2),
        contacts=("point",),
        equation="`h00 = -delta` in place of the balance of the load",
    ),
    "groove_radius": Key(
        "across, of the groove of body 2 in which body 1, a ball, rolls: speeds vary over the rows; the "
        "radius of the ball follows from it and the reduced one across; left out: one speed of each body",
        *("m", 1e-5, 10),
        contacts=("point",),
        departs="one speed across",
        assumes=("one direction of entrainment",),
        equation="`u_1(y) = u_1 (1 - y^2/(2 Rc r))`, `u_2(y) = u_2 (1 + y^2/(2 Rc R2))`, `1/r = 1/Ry + "
        "1/groove_radius`, `1/R2 = 1/Rx - 1/r`, `1/Rc = 1/r - k1/Ry`, `k1` the share of body 1 in `2/E'`",
    ),
    "length": Key(
        "of a roller of one radius: a line contact with ends; load in N, `a` and `p0` of load over length",
        *("m", 1e-6, 10),
        contacts=ROLLERS,
    ),
    "profile": Key(
        'of a roller along its length: { kind = "'
        + '" | "'.join(PROFILE)
        + '", ... }, or a table of y and z, '
        "or a file of both [m]; left out: straight",
        kind=dict,
        variants=PROFILE,
    ),
    "profile_along": Key(
        'gap of the solids along the motion beside the parabola of the radius: { kind = "'
        + '" | "'.join(ALONG)
        + '", ... }, or a table of x and z, or a file of both [m]; it rests in the contact and keeps its '
        "heights under varying radii; `a`, `p0` and film formulas are those without it",
        kind=dict,
        variants=ALONG_TABLES,
        departs="a parabola along the motion",
        equation="`g = x^2/(2 R) + z(x)`",
    ),
    "end_radius": Key(
        "of the rounds beyond both ends of a roller; left out: sharp ends, where the mesh stops",
        *("m", 1e-6, 1),
        contacts=ROLLERS,
    ),
    "free_ends": Key(
        "the end faces of a roller, body 1, are free and the ring is longer; false: both are half-spaces",
        kind=bool,
        default=True,
        contacts=ROLLERS,
        equation="deflection of the roller also by pressures mirrored about its end faces, `s = y + y'` away "
        "across and `r` in all, `y` and `y'` the distances from the face, times `(pi^2 + 4)/(pi^2 - 4) "
        "- (1 - 2 nu) ((2.42 - 0.66 nu)/(1 - nu) s/r - (1.51 - 0.39 nu) s^2/r^2 + 0.46 s^3/r^3) "
        "+ 1.5 y y'/r^2`",
    ),
    "tilt": Key(
        "misalignment of a roller or point contact: slope of the gap across; it moves a point `-tilt Ry`",
        *("rad", -0.1, 0.1),
        contacts=("point", *ROLLERS),
        needs=("contact.approach left out",),
        equation="`h = h00 + tilt y + g`, `g` the shapes and the elastic deflection",
    ),
    "self_aligning": Key(
        "the solids of a point contact or roller tilt until the moment of the pressure about y = 0 vanishes",
        kind=bool,
        default=False,
        contacts=("point", "roller"),
        needs=("contact.approach left out", "contact.tilt left out"),
    ),
    "material": Key("steel: elastic, fatigue and yield constants", choices=tuple(STEELS), many="both"),
    "youngs_modulus": Required(
        "Young's modulus, `2/E' = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`",
        "Pa",
        1e6,
        1e18,
        many="both",
        replaced_by=("material",),
    ),
    "poisson_ratio": Required("Poisson's ratio `nu`", "", 0, 0.5, many="both", replaced_by=("material",)),
    "coating": replace(
        COATING.key,
        many="both",
        departs="homogeneous bodies",
        assumes=("a contact in the plane", "half-spaces"),
    ),
    "boundary_friction": Key("friction coefficient of the solids, `|q|/p_c`", "", 0, 2, default=0.1),
    "model": Key(
        "direct: where `h = 0` the Reynolds equation is dropped; mixed: oil and solids share the load",
        choices=("direct", "mixed"),
        default="direct",
        equation="direct: `h >= 0`, `F >= 0`, `h F = 0`, `F` the residual of Reynolds; "
        "mixed: `p = p_oil + p_c`, `h >= h_b`, `p_c >= 0`, `p_c (h - h_b) = 0`",
    ),
    "asperity_height": Key(
        'rms height of the roughness finer than the mesh; "measured": that which short_cutoff removes',
        *("m", 1e-11, 1e-6),
        needs=(MIXED,),
        words=("measured",),
        equation="`p_c = beta E* (exp(3 (h - h_a)/(0.5 sigma)) - 1 + (beta E*/H)^3)^(-1/3)`, `E* = E'/2`, "
        "`sigma = asperity_height`, `h_a = adsorbed_film`, `H = asperity_hardness`",
    ),
    "asperity_stiffness": Key(
        "`beta` of that law [`2 pi sigma/L`, `L = short_cutoff`, or eight nodes without one; too soft where "
        "the roughness rolls off below `L`]",
        *("", 1e-4, 1e4),
        needs=(LAYER,),
    ),
    "asperity_slope": Key(
        "rms slope `s` of that roughness [0.1], real area of contact `A/A0 = erf(sqrt(pi) p_c/(E* s))`",
        *("", 1e-4, 10),
        needs=(LAYER,),
    ),
    "asperity_hardness": Key(
        "hardness `H` of the asperities, their pressure in full contact; left out: elastic",
        *("Pa", 1e6, 1e18),
        needs=(LAYER,),
    ),
    "adsorbed_film": Key(
        "film between asperities in full contact, by which the law of the layer is shifted",
        *("m", 0, 1e-7),
        default=0.0,
        needs=(LAYER,),
    ),
    "boundary_film": Key(
        "film below which the solids carry load [10 nm]", "m", 1e-11, 1e-6, needs=(MIXED, f"{LAYER} left out")
    ),
    "minimum_film": Key("bound of the film", "m", 0, 1e-6, default=0.0, needs=('contact.model = "direct"',)),
    "yield_pressure": Key(
        'pressure at which solids yield; "material": that of contact.material; left out: elastic',
        *("Pa", 1e6, 1e18),
        many="both",
        needs=(MIXED,),
        words=("material",),
        equation="`p <= p_y`, `d >= 0`, `(p_y - p) d = 0`, `d` the increment of plastic deformation",
    ),
}
CONTACT = KeyTable("contact", "solids and load", KEYS, required=True, values=Contact, complete=_complete)


_equations = [{name: law.equation for name, law in laws.items()} for laws in (LAWS, DENSITY_LAWS)]
VISCOSITIES, DENSITIES = ("; ".join(f"{name}: {text}" for name, text in laws.items()) for laws in _equations)

GRADE = KeyTable(
    "fluid.grade",
    f"oil of data sheets at fluid.temperature or that of [heat]; or a name: {', '.join(GRADES)}",
    {
        "v40": Required(
            "kinematic viscosity at 40 C",
            *("m^2/s", None, 0.1, 2e-6),
            equation="`lg lg(nu + 0.7) = A - B lg T`, `nu` in mm^2/s (ASTM D341); viscosity = `nu` density; "
            "secant of `ln eta` over 2000 bar `9.904 nu^0.139` /GPa (Gold et al. 2001)",
        ),
        "v100": Required("kinematic viscosity at 100 C", "m^2/s", None, 0.1, 2e-6, below="v40"),
        "density": Required(
            "at the temperature of the oil; data sheets quote 15 C, less 0.07 % per K", "kg/m^3", 500, 3000
        ),
    },
)
FLUID_KEYS = {
    "viscosity": Required("at ambient pressure", "Pa s", 1e-6, 1e4, replaced_by=("grade", "oil")),
    "grade": replace(GRADE.key, words=tuple(GRADES)),
    "oil": Key(
        "measured oil: its keys of [fluid] and [heat], which the case overrides",
        choices=tuple(OILS),
        needs=("fluid.grade left out",),
    ),
    "temperature": Key("at which grade, oil or law gives the viscosity; left out: of [heat]", "K", 200, 700),
    "law": Required("viscosity law", choices=LAWS, equation=VISCOSITIES, replaced_by=("oil",)),
    "pressure_viscosity": Key("`alpha`; left out: of grade, or of a law that has it", "1/Pa", 1e-12, 1e-6),
    "density": Required("density law", choices=DENSITY_LAWS, equation=DENSITIES, replaced_by=("oil",)),
    **{name: key for laws in LAW_TABLES for law in laws.values() for name, key in law.keys.items()},
    "limiting_shear": Key(
        "limiting shear stress over pressure",
        *("", 1e-4, 1),
        equation="mean shear stress `(tau^-20 + (limiting_shear p)^-20)^(-1/20)`, `tau` without it",
    ),
    "limiting_shear_temperature": Key(
        "`k` of `limiting_shear (1 + k (T - T0))`, with [heat]",
        *("1/K", -0.02, 0.0),
        needs=("fluid.limiting_shear",),
    ),
    "permittivity": Key("relative, for the electrical capacitance of the film", "", 1, 100),
    "inlet_film": Key("`h (1 - theta)` at the first node; left out: fully flooded", "m", 1e-10, 1e-2),
}
FLUID = KeyTable(
    "fluid", "left out: dry contact", FLUID_KEYS, values=Fluid, complete=lambda fluid: completed(vars(fluid))
)
