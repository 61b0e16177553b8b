"""The tables of a case file: every key with its type, unit, bounds, default and meaning."""
