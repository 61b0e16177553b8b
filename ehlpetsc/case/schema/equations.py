"""Equations in which keys of a case file appear, for the list of keys; by model and key."""

from ehlpetsc.physics.laws import DENSITY_LAWS, LAWS

SYMBOLS = """
Of the equations: a is the half width and p0 the largest pressure by Hertz's formulas, E' the reduced modulus,
h the film, p the pressure, p_c that of the solids, q the shear stress, theta the void fraction, eta and rho
viscosity and density, eta0 and rho0 at ambient pressure, u1 and u2 the speeds of surfaces 1 and 2,
u_max the larger one, X the abscissa and z the height of a profile; of fatigue N are the cycles to failure, de
and ds the ranges of strain and stress, D the damage.
"""
EQUATIONS = {
    "Contact.radius": "1/R = 1/R1 + 1/R2",
    "Contact.load": "w = integral of p dx; a = sqrt(8 w R/(pi E')), p0 = 2 w/(pi a)",
    "Contact.youngs_modulus": "2/E' = (1 - nu1^2)/E1 + (1 - nu2^2)/E2",
    "Contact.boundary_friction": "|q| = boundary_friction p_c",
    "Contact.model": "direct: h >= 0, F >= 0, h F = 0, F what leaving Reynolds' equation out makes up; "
    "mixed: p = p_oil + p_c, h >= h_b, p_c >= 0, p_c (h - h_b) = 0",
    "Contact.asperity_height": "p_c = beta E* exp(-h/(0.5 sigma)), E* = E'/2, sigma = asperity_height",
    "Contact.asperity_slope": "A/A0 = erf(sqrt(pi) p_c/(E* asperity_slope))",
    "Contact.yield_pressure": "p <= p_y, d >= 0, (p_y - p) d = 0, d what a step adds to the permanent set",
    "Fluid.law": "; ".join(f"{name}: {law.equation}" for name, law in LAWS.items()),
    "Grade.v40": "lg lg(nu + 0.7) = A - B lg T, nu in mm^2/s (ASTM D341); viscosity = nu density; "
    "alpha = 9.904 nu^0.139 /GPa (Gold et al. 2001)",
    "Fluid.density": "; ".join(f"{name}: {law.equation}" for name, law in DENSITY_LAWS.items()),
    "Fluid.eyring_stress": "du/dz = (tau0/eta) sinh(tau/tau0), tau0 = eyring_stress",
    "Fluid.inlet_film": "h (1 - theta) = inlet_film at the first node",
    "Motion.entrainment_speed": "u = (u1 + u2)/2",
    "Motion.slide_roll_ratio": "xi = (u1 - u2)/u; u1 = u (1 + xi/2), u2 = u (1 - xi/2)",
    "Mesh.points_per_half_width": "dx = a/points_per_half_width",
    "SurfaceProfile.cutoff": "of a wave of length L it takes 2^-(cutoff/L)^2 of the amplitude off",
    "SurfaceProfile.short_cutoff": "of a wave of length L it leaves 2^-(short_cutoff/L)^2 of the amplitude",
    "Ground.correlation": "autocorrelation exp(-(lag/correlation)^2)",
    "Bump.position": "z = +- amplitude exp(-(2 (X - position)/wavelength)^2)",
    "Wave.wavelength": "sine: z = amplitude cos(2 pi X/wavelength)",
    "Wear.coefficient": "dz/dt = k p_c |u1 - u2|, z the depth worn off a surface",
    "Fluid.limiting_shear": "mean shear stress (tau^-4 + (limiting_shear p)^-4)^(-1/4), tau without it",
    "Heat.viscosity_temperature": "ln(eta/eta0) = ln(eta(p)/eta0) - beta (T - T0)",
    "Heat.roelands_s0": "ln(eta/eta0) = c ((1 + p/pr)^z ((T - 138)/(T0 - 138))^-S0 - 1), c = alpha pr/z",
    "Heat.oil_conductivity_pressure": "k_f = oil_conductivity (1 + oil_conductivity_pressure p)",
    "Heat.thermal_expansion": "heat beta_v T h (dp/dt + u dp/dx); the density stays that of the pressure",
    "Time.travel": "the run lasts travel a/u_max",
    "Time.courant": "dt = courant dx/u_max",
    "Post.b": "de/2 = (sigma_f'/E) (2N)^b + eps_f' (2N)^c, D = sum of 1/N",
    "Post.cyclic_hardening": "de = ds/E + 2 (ds/(2 K'))^(1/n')",
    "Post.normal_sensitivity": "dgamma/2 (1 + k sigma_n/sigma_y) = (tau_f'/G) (2N)^b + gamma_f' (2N)^c",
    "Post.torsion_limit": "U = max of (tau + 3 (tau_w/sigma_w - 1/2) max(sigma_H, 0))/tau_w, "
    "tau_w in torsion, sigma_w in bending",
}
