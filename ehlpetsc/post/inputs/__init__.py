"""Loads and case of a result file, read and checked."""
