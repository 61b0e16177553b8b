"""Effects: physics, other than the film, whose state changes from time level to time level.

An effect is one module with a class derived from :class:`.effect.Effect`, with its keys and quantities, and
one entry in `EFFECTS`.
"""

from __future__ import annotations

from collections.abc import Collection

from ehlpetsc.base.quantities import register
from ehlpetsc.effects.depths import PlasticDeformation, Wear
from ehlpetsc.effects.effect import Effect
from ehlpetsc.effects.heat.effect import Heat
from ehlpetsc.effects.roughness import RoughSurfaces
from ehlpetsc.effects.scene import Scene

EFFECTS: list[type[Effect]] = [RoughSurfaces, PlasticDeformation, Wear, Heat]
for effect in EFFECTS:
    register(effect)


def effects_of(scene: Scene, records: Collection[str] = ()) -> list[Effect]:
    """Effects of a scene: the effects of its case, and effects with a record of an earlier pass.

    `records`: names of the records of an earlier pass or of a restart file.
    """
    return [kind(scene) for kind in EFFECTS if kind.is_in(scene.case) or kind.name in records]
