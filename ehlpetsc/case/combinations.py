"""Members of a series: the same case with one key, or several, set to one value after the other."""

import copy
import itertools

from ehlpetsc.case.faults import show
from ehlpetsc.case.settings import put


def keys_of(series):
    """Keys that are swept, dotted.

    Parameters
    ----------
    series : dict
        The table as written in the file.
    """
    return [series["key"]] if "key" in series else list(series["keys"])


def combinations(series):
    """Values of the keys for each member, a tuple each: all of the one key, a grid of several, or in step."""
    if "key" in series:
        return [(value,) for value in series["values"]]
    if series.get("combine", "grid") == "step":
        return list(zip(*series["values"], strict=True))
    return list(itertools.product(*series["values"]))


def settings_of(series):
    """Settings of each member: pairs of a split key and its value."""
    keys = [key.split(".") for key in keys_of(series)]
    return [list(zip(keys, values, strict=True)) for values in combinations(series)]


def member_tables(data, settings):
    """Tables of one member: those of the case without its series.

    Raises
    ------
    ValueError
        A key is none of this case.
    """
    member = copy.deepcopy(data)
    del member["series"]
    for keys, value in settings:
        put(member, keys, value)
    return member


def series_faults(path, data, faults_of):
    """Faults that only a member of the series has.

    Parameters
    ----------
    path : path-like
    data : dict
        Tables of the case.
    faults_of : callable
        Faults of the tables of one member.
    """
    if "series" not in data:
        return []
    faults = []
    for settings in settings_of(data["series"]):
        try:
            member = member_tables(data, settings)
        except ValueError:
            named = ", ".join(show(key) for key in keys_of(data["series"]))
            return [f"{path}: series.key = {named}: allowed: a key of this case"]
        values = ", ".join(show(value) for _, value in settings)
        faults += [f"{fault} (series.values: {values})" for fault in faults_of(member)]
    return faults
