"""Keys of `[fluid]`: the oil."""

from __future__ import annotations

from ehlpetsc.keys import Key, KeyTable, Required
from ehlpetsc.materials import GRADES
from ehlpetsc.physics.laws import DENSITY_LAWS, LAWS, completed

_equations = [{name: law.equation for name, law in laws.items()} for laws in (LAWS, DENSITY_LAWS)]
VISCOSITY, DENSITY = ("; ".join(f"{name}: {text}" for name, text in laws.items()) for laws in _equations)

GRADE = KeyTable(
    "fluid.grade",
    f"oil of data sheets at fluid.temperature or that of [heat]; or a name: {', '.join(GRADES)}",
    {
        "v40": Required(
            "kinematic viscosity at 40 C",
            *("m^2/s", None, 0.1, 2e-6),
            equation="lg lg(nu + 0.7) = A - B lg T, nu in mm^2/s (ASTM D341); viscosity = nu density; "
            "alpha = 9.904 nu^0.139 /GPa (Gold et al. 2001)",
        ),
        "v100": Required("kinematic viscosity at 100 C", "m^2/s", None, 0.1, 2e-6, below="v40"),
        "density": Required(
            "at the temperature of the oil; data sheets quote 15 C, less 0.07 % per K",
            "kg/m^3",
            500,
            3000,
        ),
    },
)
KEYS = {
    "viscosity": Required("at ambient pressure", "Pa s", 1e-6, 1e4, replaced_by=("grade",)),
    "grade": GRADE.key,
    "temperature": Key(
        "at which grade or a law of temperature gives the viscosity; left out: that of [heat]", "K", 200, 700
    ),
    "law": Required("viscosity law", choices=tuple(LAWS), equation=VISCOSITY),
    "pressure_viscosity": Key("alpha; left out: of grade, or of a law that has it", "1/Pa", 1e-12, 1e-6),
    "density": Required("density law", choices=tuple(DENSITY_LAWS), equation=DENSITY),
    **{name: key for laws in (LAWS, DENSITY_LAWS) for law in laws.values() for name, key in law.keys.items()},
    "eyring_stress": Key("tau0, du/dz = (tau0/eta) sinh(tau/tau0); left out: Newtonian", "Pa", 1e3, 1e12),
    "limiting_shear": Key(
        "limiting shear stress over pressure",
        *("", 1e-4, 1),
        equation="mean shear stress (tau^-4 + (limiting_shear p)^-4)^(-1/4), tau without it",
    ),
    "inlet_film": Key("h (1 - theta) at the first node; left out: fully flooded", "m", 1e-10, 1e-2),
}
FLUID = KeyTable("fluid", "left out: dry contact", KEYS, complete=lambda fluid: completed(vars(fluid)))
