"""Pictures and movies of stored frames."""
