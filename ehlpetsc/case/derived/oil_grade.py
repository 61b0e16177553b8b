"""Keys of `[fluid]` derived from an oil grade of data sheets."""

from ehlpetsc.case.schema.table import is_of

MM2 = 1e6  # mm^2/s in m^2/s


def with_grade(tables):
    """Tables of a case with the viscosity of its oil grade, unless the case has a viscosity.

    Walther's equation (ASTM D341) at `fluid.temperature`, default: the reference temperature of `[heat]`,
    times the density; `pressure_viscosity` by Gold et al. (2001). Argument and result as of
    :func:`ehlpetsc.case.derived.solids.with_material`; a grade needs a temperature.
    """
    fluid, heat = tables.get("fluid"), tables.get("heat", {})
    grade = fluid.get("grade") if isinstance(fluid, dict) else None
    if not isinstance(grade, dict) or not isinstance(heat, dict):
        return tables
    v40, v100, density = (grade.get(key) for key in ("v40", "v100", "density"))
    temperature = _temperature(fluid, heat)
    if not all(is_of(float, value) and value > 0.0 for value in (v40, v100, density, temperature)):
        return tables
    if not (2e-6 < v100 < v40 < 1.0 and 200.0 < temperature < 700.0):
        return tables
    from ehlpetsc.physics.laws import gold_pressure_viscosity, walther, walther_constants

    nu = float(walther(temperature, *walther_constants(v40, v100))[0])
    properties = {"viscosity": nu / MM2 * density, "pressure_viscosity": gold_pressure_viscosity(nu)}
    tables = tables | {"fluid": properties | fluid}
    return tables | {"heat": {"oil_density": density} | heat} if heat else tables


def _temperature(fluid, heat):
    """Temperature at which `viscosity` holds [K], None if there is none."""
    bulk = heat.get("bulk_temperature")
    if isinstance(bulk, (list, tuple)):
        numbers = len(bulk) == 2 and all(is_of(float, value) for value in bulk)
        bulk = 0.5 * sum(bulk) if numbers else None
    given = heat.get("reference_temperature"), fluid.get("temperature"), heat.get("inlet_temperature"), bulk
    return next((value for value in given if value is not None), None)
