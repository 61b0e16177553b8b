"""Seed and number of draws of fuzz tests."""

import os

SEED = int(os.environ.get("EHL_FUZZ_SEED", "1"))


def draws(usual):
    """EHL_FUZZ of the environment, or the usual number."""
    return int(os.environ.get("EHL_FUZZ", usual))
