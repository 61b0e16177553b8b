"""Members of a series: the same case with different values of one or several keys."""

import copy
import itertools

from ehlpetsc.case.faults import show
from ehlpetsc.case.settings import put


def keys_of(series):
    """Dotted keys that vary over the series.

    Parameters
    ----------
    series : dict
        Table `[series]` of the case file.
    """
    return [series["key"]] if "key" in series else list(series["keys"])


def combinations(series):
    """Tuples of the values of the keys for each member: of one key, a grid of several, or in parallel."""
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
    """Tables of one member: tables of the case without `[series]`.

    Raises
    ------
    ValueError
        A key does not exist in this case.
    """
    member = copy.deepcopy(data)
    del member["series"]
    for keys, value in settings:
        put(member, keys, value)
    return member


def series_faults(path, data, faults_of):
    """Faults of members that the base case does not have.

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
