"""Runs of the study: finer references, then one setting of the case varied at a time."""

from ehlpetsc.study.setting import ATOL, MESH, NEAR, RANKS, RTOL, STEP, Setting

TOLERANCES = {ATOL: (1e-2, 1e-3, 1e-4, 1e-5, 1e-7), RTOL: (1e-1, 1e-2, 1e-4, 1e-6, 1e-8)}
REFERENCE_TOLERANCES = {ATOL: 1e-9, RTOL: 1e-10}
NEAR_FIELDS = (5, 10, 20, 40)


def plan(case, meshes, steps, ranks):
    """Runs of the study: references, then each setting varied about that of the case.

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
    base = {MESH: case.mesh.points_per_half_width, NEAR: case.mesh.near_field, RANKS: 1}
    finest = {MESH: 2 * max(meshes), **REFERENCE_TOLERANCES}
    varied = [(MESH, meshes), (NEAR, NEAR_FIELDS), *TOLERANCES.items(), (RANKS, ranks)]
    if case.time:
        base[STEP], finest[STEP] = case.time.courant, 0.5 * min(steps)
        varied.insert(1, (STEP, steps))
    references = []
    for coarser in (1, 2, 4):
        values = {**base, **finest, MESH: finest[MESH] // coarser}
        if case.time:
            values[STEP] = finest[STEP]  # dt is proportional to dx
        references.append(Setting(values, "reference", f"{coarser}"))
    runs = [Setting(base, label="as it is")]
    for key, values in varied:
        distinct = {*values, base[key]} if key in base else values
        runs += [Setting({**base, key: value}, key, value) for value in sorted(distinct)]
    return references, runs
