"""Files of profiles and maps."""
