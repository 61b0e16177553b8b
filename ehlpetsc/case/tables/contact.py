"""Keys of `[contact]` and `[wear]`: solids, load, contact model, wear rate."""

from __future__ import annotations

from typing import Any

from ehlpetsc.keys import Key, KeyTable, Values
from ehlpetsc.materials import STEELS

BOUNDARY_FILM = 10e-9  # m: an adsorbed or reacted layer has 2 to 50 nm
ASPERITY_DEFAULTS = {"asperity_stiffness": 1.0, "asperity_slope": 0.1}  # ground and superfinished steel
MIXED = 'contact.model = "mixed"'


class Contact(Values):
    """`[contact]`: solids and load."""

    @property
    def has_contact_pressure(self) -> bool:
        """Whether the pressure of the solids is separate from that of the oil."""
        return self.model == "mixed"

    @property
    def law(self) -> str:
        """Contact law: "direct", "mixed" (rigid below the boundary film) or "compliant"."""
        return self.model if self.asperity_height is None else "compliant"


def _complete(contact: Contact) -> dict[str, Any]:
    if contact.law == "mixed":
        return {"boundary_film": contact.boundary_film or BOUNDARY_FILM}
    if contact.law == "compliant":
        return {key: getattr(contact, key) or value for key, value in ASPERITY_DEFAULTS.items()}
    return {}


CONTACT = KeyTable(
    "contact",
    "solids and load",
    {
        "radius": Key(
            "radius of relative curvature",
            unit="m",
            ge=1e-9,
            le=100,
            required=True,
            replaced_by=("[gears]", "[operation]"),
            equation="1/R = 1/R1 + 1/R2",
        ),
        "load": Key(
            "load per length of contact",
            unit="N/m",
            ge=1e-3,
            le=1e10,
            required=True,
            replaced_by=("[gears]", "[operation]"),
            equation="w = integral of p dx; a = sqrt(8 w R/(pi E')), p0 = 2 w/(pi a)",
        ),
        "material": Key(
            "steel: elastic and fatigue constants, and the pressure at which it yields",
            str,
            choices=tuple(STEELS),
            many="both",
        ),
        "youngs_modulus": Key(
            "Young's modulus",
            unit="Pa",
            ge=1e6,
            le=1e18,
            many="both",
            required=True,
            replaced_by=("material",),
            equation="2/E' = (1 - nu1^2)/E1 + (1 - nu2^2)/E2",
        ),
        "poisson_ratio": Key(
            "Poisson's ratio", ge=0, le=0.5, many="both", required=True, replaced_by=("material",)
        ),
        "boundary_friction": Key(
            "boundary friction coefficient: shear stress over pressure of the solids",
            ge=0,
            le=2,
            default=0.0,
            equation="|q| = boundary_friction p_c",
        ),
        "model": Key(
            "direct: where h = 0 the Reynolds equation is dropped, F its residual; mixed: oil and solids "
            "share the load",
            str,
            choices=("direct", "mixed"),
            default="direct",
            equation="direct: h >= 0, F >= 0, h F = 0; "
            "mixed: p = p_oil + p_c, h >= h_b, p_c >= 0, p_c (h - h_b) = 0",
        ),
        "asperity_height": Key(
            "rms height of the roughness finer than the mesh, whose asperities carry load, in place of "
            'boundary_film; "measured": the height that short_cutoff removes, of both surfaces together',
            unit="m",
            ge=1e-11,
            le=1e-6,
            needs=(MIXED,),
            equation="p_c = beta E* exp(-h/(0.5 sigma)), E* = E'/2, sigma = asperity_height",
        ),
        "asperity_stiffness": Key(
            "beta of that law [1]; theory: 6 to 11 times asperity_height over the longest wave",
            ge=1e-4,
            le=1e4,
            needs=("contact.asperity_height",),
        ),
        "asperity_slope": Key(
            "rms slope of that roughness, for the real area of contact [0.1]",
            ge=1e-4,
            le=10,
            needs=("contact.asperity_height",),
            equation="A/A0 = erf(sqrt(pi) p_c/(E* asperity_slope))",
        ),
        "boundary_film": Key(
            "film below which the solids carry load [10 nm]",
            unit="m",
            ge=1e-11,
            le=1e-6,
            needs=(MIXED, "contact.asperity_height left out"),
        ),
        "minimum_film": Key(
            "bound of the film thickness",
            unit="m",
            ge=0,
            le=1e-6,
            default=0.0,
            needs=('contact.model = "direct"',),
        ),
        "yield_pressure": Key(
            'pressure at which solids yield; "material": that of contact.material; left out: elastic',
            unit="Pa",
            ge=1e6,
            le=1e18,
            many="both",
            needs=(MIXED,),
            equation="p <= p_y, d >= 0, (p_y - p) d = 0, d the increment of plastic deformation",
        ),
    },
    required=True,
    values=Contact,
    complete=_complete,
)

WEAR = KeyTable(
    "wear",
    "left out: no wear",
    {
        "coefficient": Key(
            "specific wear rate k",
            unit="m^2/N",
            ge=0,
            le=1e-10,
            many="both",
            required=True,
            equation="dz/dt = k p_c |u1 - u2|, z the depth worn off a surface",
        )
    },
    needs=(MIXED, "[time]"),
)
