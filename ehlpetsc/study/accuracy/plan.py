"""Runs of the study: references finer than all, then one setting of the case varied at a time."""

from dataclasses import dataclass, field

MESH, STEP, NEAR = "mesh.points_per_half_width", "time.courant", "mesh.near_field"
ATOL, RTOL = "-snes_atol", "-ksp_rtol"
TOLERANCES = {ATOL: (1e-2, 1e-3, 1e-4, 1e-5, 1e-7), RTOL: (1e-1, 1e-2, 1e-4, 1e-6, 1e-8)}
TIGHT = {ATOL: 1e-9, RTOL: 1e-10}
NEAR_FIELDS = (5, 10, 20, 40)


@dataclass
class Setting:
    """One run of the study: which setting is varied, to what, and all values."""

    varied: str
    value: object
    values: dict = field(default_factory=dict)

    @property
    def ranks(self):
        return self.values["ranks"]

    def overrides(self):
        """Settings of the case file."""
        return [f"{key}={value}" for key, value in self.values.items() if "." in key]

    def options(self):
        """Options of PETSc."""
        pairs = [(key, f"{value:g}") for key, value in self.values.items() if key.startswith("-")]
        return [word for pair in pairs for word in pair]


def plan(case, meshes, steps, ranks):
    """Runs of the study: references first, then each setting varied about the case as it is.

    Parameters
    ----------
    case : case.loading.Case
    meshes : sequence of int
        Points per half width.
    steps : sequence of float
        Courant numbers; not used by a steady case.
    ranks : sequence of int

    Returns
    -------
    references : list of Setting
        Finest first.
    runs : list of Setting
    """
    base = {MESH: case.mesh.points_per_half_width, NEAR: case.mesh.near_field, "ranks": 1}
    finest = {MESH: 2 * max(meshes), **TIGHT}
    varied = [(MESH, meshes), (NEAR, NEAR_FIELDS), *TOLERANCES.items(), ("ranks", ranks)]
    if case.time:
        base[STEP], finest[STEP] = case.time.courant, 0.5 * min(steps)
        varied.insert(1, (STEP, steps))
    references = []
    for coarser in (1, 2, 4):
        values = {**base, **finest, MESH: finest[MESH] // coarser}
        if case.time:
            values[STEP] = finest[STEP]  # dt goes with dx
        references.append(Setting("reference", f"{coarser}", values))
    runs = [Setting("", "as it is", base)]
    for key, values in varied:
        known = {*values, base[key]} if key in base else values
        runs += [Setting(key, value, {**base, key: value}) for value in sorted(known)]
    return references, runs
