"""Pictures and movies of lives and of their regimes."""
