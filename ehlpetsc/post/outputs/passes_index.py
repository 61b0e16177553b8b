"""Damage of every pass of a run, added to the index of its passes."""

import json
from pathlib import Path

from ehlpetsc.results.atomic_write import atomic_write
from ehlpetsc.results.output_guard import Lock
from ehlpetsc.results.post_result import damage_beside
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.series_index import read_index


def is_of_passes(path):
    """Whether a name is that of an index of passes, ``OUTPUT.passes.json``."""
    return Path(path).name.endswith(".passes.json")


def note_damage(index):
    """Add the damage of the post-processing to each pass of an index, under "damage".

    Parameters
    ----------
    index : path-like
        Index of processed passes.

    Returns
    -------
    list of (int, dict)
        Number and damage of each pass, see `ehlpetsc.results.post_result.PostResult.summary`.

    Raises
    ------
    OutputError
        The index cannot be read or written, for instance because another process is writing it.
    """
    index = Path(index)
    with Lock(index, "wait for it"):
        content, damages = read_index(index), []
        for row in content["passes"]:
            with read_result(index.with_name(row["file"])) as result:
                damage = damage_beside(result)
            if damage is not None:
                row["damage"] = damage.summary()
                damages.append((row["pass"], row["damage"]))
        atomic_write(index, json.dumps(content, indent=1).encode())
    return damages
