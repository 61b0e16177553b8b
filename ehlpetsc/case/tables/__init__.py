"""The tables of a case file: every key with its type, unit, bounds, default and meaning.

Attribute names are the keys (`lambda` is `lambda_`). Bounds are wide enough for any machine element in SI
units and narrow enough to detect a value in GPa, mm or um.
"""
