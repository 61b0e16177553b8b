"""Result files of planes for the tests of post-processing: loads over x and y that travel with surfaces."""

import numpy as np

from support.made_loads import P0, A, write

FRICTION = 0.05


def write_plane(path, scene, kind, y, pressure, maps=None, extra=None, **options):
    """Write a result of a plane with the case and the steps of a line's `Scene`.

    `kind`: "strip" or "point". `pressure` (frames, ny, nx). `maps`: heights (ny, ns) by surface over the
    abscissae of the scene's profiles. `extra`: other fields by name. `options`: of :func:`write`.
    """

    def edit(file):
        drag, shape = FRICTION * pressure, pressure.shape[1:]
        fields = {"pressure": pressure, "shear_stress_1": -drag, "shear_stress_2": drag} | (extra or {})
        file.attrs.update(kind=kind, b=A)
        file["y"] = y
        for name, values in fields.items():
            if name in file:
                del file[name]
            file.create_dataset(name, data=values, maxshape=(None, *shape), chunks=(4, *shape))
        for side in ("1", "2"):
            profile = file[f"surface/{side}/z"][:]
            del file[f"surface/{side}/z"]
            file[f"surface/{side}/z"] = maps[side] if maps else np.tile(profile, (y.size, 1))

    return write(path, scene, edit=edit, **options)


def sphere(scene, y):
    """Hertz pressure of a sphere (ny, nx), with y in metres."""
    return P0 * np.sqrt(np.clip(1 - (scene.x / A) ** 2 - (y[:, None] / A) ** 2, 0, None))
